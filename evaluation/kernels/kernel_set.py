"""The kernels that a kind of run needs: tells whether they are compiled, and has them compiled."""

from collections.abc import Callable
from dataclasses import dataclass

from evaluation.kernels.cache import is_compiled, note_kernels


@dataclass(frozen=True, slots=True, kw_only=True)
class KernelSet:
    """What has to be compiled before a kind of run is as fast as it can be."""

    owner: str
    """Whose kernels they are, for telling users: ``mapper graph``."""
    kind: str
    """The kind of run that is noted beside the compiled code."""
    call: Callable[[], None]
    """A short run that calls each of them; numba keeps what it compiles for the next process."""

    @property
    def is_ready(self) -> bool:
        """Whether all of them are compiled."""
        return is_compiled(self.kind)

    def compile(self) -> None:
        """Call them, and note which ones they were."""
        self.call()
        note_kernels(self.kind)
