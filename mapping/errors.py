"""The one exception root of the testbed: bad input, told in one line."""


class TestbedError(Exception):
    """Input that the testbed cannot use.

    Its message is one line that names the file or setting, the value found and what is allowed;
    the command line prints it and exits with status 2.
    """

    __test__ = False  # keeps pytest from collecting it as a test class
