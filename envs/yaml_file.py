"""Turns a YAML file into the mapping in it, or into one line that says where it is none."""

import re
from pathlib import Path
from typing import Any

import yaml

from mapping.errors import TestbedError

try:  # libyaml reads a plan of a thousand boxes ten times faster, where PyYAML was built with it
    from yaml import CSafeLoader as _SafeLoader
except ImportError:
    from yaml import SafeLoader as _SafeLoader  # type: ignore[assignment]


def load_yaml(path: Path) -> dict[str, Any]:
    """The mapping in a YAML file.

    Raises:
        TestbedError: The file is missing, unreadable, no YAML, no mapping, or says a key twice.
    """
    try:
        fields = yaml.load(path.read_text(encoding="utf-8"), Loader=_Loader)
    except FileNotFoundError:
        raise TestbedError(f"{path}: no such file; must be a floor plan in YAML") from None
    except (OSError, UnicodeDecodeError) as error:
        raise TestbedError(f"{path}: cannot be read as text ({error})") from error
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise TestbedError(f"{path}: line {line}: not YAML ({error.problem})") from None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise TestbedError(f"{path}: not YAML ({' '.join(str(error).split())})") from None
    if not isinstance(fields, dict):
        raise TestbedError(f"{path}: no mapping of keys to values; must be a floor plan in YAML")
    return fields


class _Loader(_SafeLoader):
    """YAML 1.1 that refuses a key said twice, of which PyYAML would silently keep the last."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """The mapping of a node whose keys all differ."""
        seen: set[str] = set()
        for key, _ in node.value:
            if isinstance(key.value, str) and key.value in seen:
                raise yaml.constructor.ConstructorError(
                    problem=f"{key.value!r} stands twice", problem_mark=key.start_mark
                )
            seen.add(str(key.value))
        return super().construct_mapping(node, deep)


# YAML 1.1 takes 1e-2 for text; YAML 1.2, and everybody, for a number.
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"[-+]?[0-9]+(\.[0-9]*)?[eE][-+]?[0-9]+$"),
    list("-+0123456789"),
)
