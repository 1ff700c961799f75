"""Access to the compiled core: its import, its back ends, and a check of a law's gains."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

from detumble.checking import instance
from detumble.errors import RequestError, ScenarioError
from detumble.text import did_you_mean

if TYPE_CHECKING:
    from types import ModuleType

    import numpy as np
    from numpy.typing import ArrayLike, NDArray


def core() -> ModuleType:
    """Give the compiled module.

    Raises:
        RequestError: it has not been built.
    """
    try:
        import numpy as np  # noqa: F401  # the core would load it itself, and panic if Ctrl-C came during that

        from detumble import _core
    except ImportError as error:
        raise RequestError(f"the compiled core cannot be loaded ({error}); `make setup` builds it") from None
    return _core


@cache
def register() -> dict[str, Any]:
    """Give what the core calls its results: `metrics`, `causes`, `codes`, `thresholds`, `state` and `series`; see `_core.pyi`.

    Raises:
        RequestError: the core has not been built.
    """
    names: dict[str, Any] = core().register()
    return names


def tick_times(period: float, ticks: ArrayLike) -> NDArray[np.float64]:
    """Give the times of control ticks, s, as histories and metrics have them: the doubles nearest to the decimals k T.

    Args:
        period: of control, s.
        ticks: (n,) whole numbers from 0 on.
    """
    import numpy as np

    times: NDArray[np.float64] = core().tick_times(period, np.asarray(ticks, np.uint64))
    return times


def checked_backend(name: str | None) -> str | None:
    """Make sure that this machine has a back end; None leaves the choice to the core.

    Raises:
        RequestError: there is no such back end here.
    """
    known: list[str] = core().backends()
    if name is not None:
        instance("backend", name, str, f"one of {', '.join(known)}")
    if name is not None and name not in known:
        raise RequestError(
            f"no back end {name!r} on this machine{did_you_mean(name, known)}; there are {', '.join(known)}"
        )
    return name


def check_gains(title: str, core_case: dict[str, Any]) -> None:
    """Make sure that the core finds the gains of a law, before any work is begun.

    Args:
        title: of the scenario.
        core_case: as `scenario.core.case` gives it.

    Raises:
        ScenarioError: it does not.
    """
    try:
        core().fly_many(core_case, {}, 0)  # no flight
    except ValueError as error:
        raise ScenarioError(title, problem=str(error)) from None
