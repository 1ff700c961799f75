"""The paper's claims, each with a verdict that follows from the numbers by a rule written here.

`numbers` are those of `docs/study/numbers.json`. "Fastest", "second" and "slowest" are of `detumble compare`: an entry is above
another only where every tuning is, where the paired test is significant, and where the difference is of use.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from statistics import median
from typing import Any

from detumble.scenario.laws import TITLES
from study.cases import CASES, PUBLISHED_TIME

Numbers = dict[str, Any]
SIGNIFICANT = 0.05
PRRL, LQR, PD = TITLES["prrl"], TITLES["lqr"], TITLES["pd"]


@dataclass(frozen=True)
class Claim:
    """One claim of the paper.

    Attributes:
        text: what it says.
        verdict: what the numbers say to that.
        number: the numbers.
        command: that shows them.
    """

    text: str
    verdict: str
    number: str
    command: str


def claims(numbers: Numbers) -> list[Claim]:
    """Judge every claim."""
    return [
        _fastest(numbers),
        _reach(numbers),
        _alpha(numbers),
        _finite_time(numbers),
        _inertia(numbers),
        _effort(numbers),
        _second(numbers),
        _slowest(numbers),
    ]


def _printed(comparison: Numbers) -> dict[str, Numbers]:
    """The printed entries, by name."""
    return {entry["name"]: entry for entry in comparison["entries"] if entry["form"] == "printed"}


def _above(comparison: Numbers, one: str, other: str) -> bool:
    placed = next(entry for entry in comparison["ranking"] if entry["name"] == one)
    return other in placed["above"]


def _where(held: dict[str, bool], yes: str, no: str) -> str:
    """Say in words in which cases something holds."""
    places = [case.title for case in CASES if held[case.key]]
    if len(places) == len(held):
        return yes
    return f"{no}, except: {'; '.join(places)}" if places else no


def _objectives(comparison: Numbers) -> str:
    """Objective of each printed entry on held-out runs, in words; or that it succeeds too seldom."""

    def worded(entry: Numbers) -> str:
        if entry["short_of_required"]:
            return f"fails in {100.0 * (1.0 - entry['success']):.3g} %"
        return f"{entry['objective']:.3g} s"

    return ", ".join(f"{name} {worded(entry)}" for name, entry in _printed(comparison).items())


def _everywhere(numbers: Numbers) -> str:
    return "; ".join(f"{case.title}: {_objectives(numbers['compare'][case.key])}" for case in CASES)


_COMPARE = "; ".join(f"detumble compare {case.arguments}" for case in CASES)


def _ranks(numbers: Numbers, name: str) -> str:
    """The rank of an entry among the five printed ones, case by case."""

    def rank(comparison: Numbers) -> int:
        return 1 + sum(_above(comparison, other, name) for other in _printed(comparison))

    return f"{name} ranks " + "; ".join(f"{case.title}: {rank(numbers['compare'][case.key])} of 5" for case in CASES)


def _fastest(numbers: Numbers) -> Claim:
    held = {}
    for case in CASES:
        comparison = numbers["compare"][case.key]
        others = [name for name in _printed(comparison) if name != PRRL]
        held[case.key] = all(_above(comparison, PRRL, other) for other in others)
    return Claim(
        "PRRL-SMC captures fastest of the five laws",
        _where(held, "holds after equal tuning", "not after equal tuning"),
        _everywhere(numbers),
        _COMPARE,
    )


def _reach(numbers: Numbers) -> Claim:
    reach = numbers["reach"]
    return Claim(
        f"PRRL-SMC captures after {PUBLISHED_TIME} s (start not published)",
        "feasible only from starts within reach",
        f"at rest: from every direction up to {reach['every_direction_up_to_m']:.3g} m off the goal, from none at "
        f"{reach['no_direction_from_m']:.3g} m or more, whatever the controller",
        "detumble bound paper --set chaser.position=[0,1.4,0]",
    )


def _alpha(numbers: Numbers) -> Claim:
    rising, trends, texts = [], [], []
    for case in CASES[:2]:
        alpha = numbers["alpha"][case.key]
        given = [one["mean_s"] for one in alpha["given"]]
        rising.append(all(sooner <= later for sooner, later in pairwise(given)))
        trends.append(_trend(alpha))
        medians = ", ".join(f"{median(one['mean_s'] for one in row):.3g}" for row in alpha["tuned"])
        texts.append(
            f"{case.title}, α {', '.join(str(value) for value in alpha['alpha'])}: given gains "
            f"{', '.join(f'{time:.3g}' for time in given)} s; tuned, median of three searches, {medians} s"
        )
    places = [case.title for case, rises in zip(CASES, rising, strict=False) if rises]
    at_equal_gains = f"true in {'; '.join(places)}" if places else "not so"
    return Claim(
        "α closer to 0 is faster far from the surface",
        f"at equal gains: {at_equal_gains}; at equal budget: {'a trend' if any(trends) else 'no trend'}",
        "; ".join(texts),
        "make study (study/alpha.py)",
    )


def _trend(alpha: Numbers) -> bool:
    """Whether the tuned times rise with α: Kendall's tau over all searches, one-sided, 5 %."""
    from scipy.stats import kendalltau  # type: ignore[import-untyped]  # scipy carries no types

    pairs = [(value, one["mean_s"]) for value, row in zip(alpha["alpha"], alpha["tuned"], strict=True) for one in row]
    return bool(kendalltau(*zip(*pairs, strict=True), alternative="greater").pvalue < SIGNIFICANT)


def _finite_time(numbers: Numbers) -> Claim:
    surfaces = numbers["surfaces"]

    def reached(entry: str) -> str:
        times = surfaces[entry]["reached_s"]
        return ", ".join("not in 600 s" if time is None else f"{time:.3g} s" for time in times)

    printed = surfaces["tsmc, printed"]["reached_s"]
    return Claim(
        "TSMC converges in finite time",
        "not as printed (p/q > 1); as corrected (p/q < 1) it does" if printed[-1] is None else "holds as printed",
        f"to 10, 1, 0.1, 0.01 cm: printed {reached('tsmc, printed')}; corrected {reached('tsmc, corrected')}",
        "make study (study/surfaces.py)",
    )


def _inertia(numbers: Numbers) -> Claim:
    under = numbers["handover"]["given"]
    texts, good = [], True
    for condition, laws in under.items():
        prrl = laws["prrl"]
        good &= prrl["settled_of_captured"] >= 0.99
        rank = sorted(laws, key=lambda law: laws[law]["settling_median_s"] or float("inf")).index("prrl") + 1
        texts.append(
            f"{condition}: {100 * prrl['settled_of_captured']:.4g} % settle, median {prrl['settling_median_s']:.3g} s "
            f"(rank {rank} of {len(laws)})"
        )
    return Claim(
        "PRRL-SMC handles the change of inertia at capture",
        "holds with the given gains, also where momentum is conserved" if good else "not where momentum is conserved",
        "; ".join(texts),
        "detumble campaign paper_dispersed --law prrl --set capture.transition=momentum_conserving --out DIR",
    )


def _effort(numbers: Numbers) -> Claim:
    given = numbers["given"]
    as_given = ", ".join(f"{TITLES[law]} {entry['delta_v_to_capture_m_s']:.3g}" for law, entry in given.items())
    most_as_given = max(given, key=lambda law: given[law]["delta_v_to_capture_m_s"]) == "prrl"
    held = {}
    texts = []
    for case in CASES:
        printed = _printed(numbers["compare"][case.key])
        fuel = {
            name: entry["delta_v_to_capture_m_s"]["p50"]
            for name, entry in printed.items()
            if not entry["short_of_required"]
        }
        held[case.key] = PRRL in fuel and fuel[PRRL] > 1.005 * max(
            [value for name, value in fuel.items() if name != PRRL], default=0.0
        )
        texts.append(f"{case.title}: " + ", ".join(f"{name} {value:.3g}" for name, value in fuel.items()))
    first = "with the given gains it does" if most_as_given else "not even with the given gains"
    return Claim(
        "PRRL-SMC costs more effort",
        f"{first}; tuned for speed: {_where(held, 'it does', 'it does not')}",
        f"median Δv to capture, m/s: given gains {as_given}; tuned {'; '.join(texts)}",
        "detumble paper; detumble compare paper",
    )


def _second(numbers: Numbers) -> Claim:
    held = {}
    for case in CASES:
        comparison = numbers["compare"][case.key]
        others = [name for name in _printed(comparison) if name not in (PRRL, LQR)]
        held[case.key] = all(_above(comparison, LQR, other) for other in others)
    return Claim(
        "LQR is second best",
        _where(held, "holds after equal tuning", "not after equal tuning"),
        _ranks(numbers, LQR),
        _COMPARE,
    )


def _slowest(numbers: Numbers) -> Claim:
    held = {}
    for case in CASES:
        comparison = numbers["compare"][case.key]
        others = [name for name in _printed(comparison) if name != PD]
        held[case.key] = all(_above(comparison, other, PD) for other in others)
    return Claim(
        "PD is the slowest",
        _where(held, "holds after equal tuning", "not after equal tuning"),
        _ranks(numbers, PD),
        _COMPARE,
    )
