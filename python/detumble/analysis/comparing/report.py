"""A comparison as tables for a terminal."""

from __future__ import annotations

import math
import textwrap
from typing import TYPE_CHECKING

from detumble.analysis.comparing.pairs import METRICS, OBJECTIVES, STATISTIC
from detumble.analysis.comparing.plan import SPREAD
from detumble.analysis.comparing.ratios import FUEL_RUNS
from detumble.tables import fixed, table

if TYPE_CHECKING:
    from detumble.analysis.comparing.judged import Judged
    from detumble.analysis.comparing.pairs import Pair
    from detumble.analysis.comparing.result import Comparison
    from detumble.campaigns.statistics.summaries import Quantile

SHOWN = {"belief": (0.5, 0.7, 1.3, 1.5), "noise": (3.0, 10.0), "control_period_s": (0.2, 0.5, 1.0)}
"""Deviations in the table; the JSON file has them all."""


def text_of(comparison: Comparison) -> str:
    """Write the tables: order, statistics, distance from the bound, paired tests, spread of the tunings, robustness."""
    parts = [
        _headline(comparison),
        _standings(comparison),
        _notes(comparison),
        _ratios(comparison),
        _against(comparison),
    ]
    if not comparison.plan.as_given:
        parts.append(_tunings(comparison))
    if comparison.plan.robust:
        parts.append(_robustness(comparison))
    return "\n\n".join(parts)


def _headline(comparison: Comparison) -> str:
    plan = comparison.plan
    budget, starts = _counted(plan.budget, "evaluation"), _counted(plan.starts, "start")
    searched = f"{_counted(plan.tunings, 'tuning')} each of {budget} on {starts} of seed {plan.seed}"
    how = f"{'gains as given' if plan.as_given else searched}, horizon {plan.horizon:.4g} s"
    goal = (
        f"{plan.objective.statistic} of {plan.objective.meaning}, success at least {100 * plan.objective.required:g} %"
    )
    return f"{comparison.scenario.title}\n{goal}; {how}\njudged on {_counted(plan.runs, 'run')} of seed {plan.judging}"


def _standings(comparison: Comparison) -> str:
    header = ("rank", "entry", "ties", "success %", "95 % interval", "capture s", "95th", "settled s", "95th")
    rows: list[tuple[str, ...]] = [(*header, "Δv m/s", "force sat. %", "torque sat. %")]
    for place in comparison.ordered:
        judged, ranking = comparison.entries[place], comparison.ranking
        success, figures = judged.verdict.success, judged.verdict.figures
        capture, settled, delta_v = (
            figures[name] for name in ("capture_time_s", "settled_time_s", "delta_v_to_capture_m_s")
        )
        shares = (figures[name].median for name in ("force_saturated_share", "torque_saturated_share"))
        rows.append(
            (
                str(ranking.ranks[place]),
                judged.entry.name,
                ranking.letters[place],
                fixed(100 * success.share, 2),
                f"{100 * success.low:.2f} – {100 * success.high:.2f}",
                _number(capture.median, 2),
                _number(capture.high, 2),
                _number(settled.median, 1),
                _number(settled.high, 1),
                _number(delta_v.median, 4),
                *(_number(share, 1, 100.0) for share in shares),
            )
        )
    return _second_column_left(rows)


def _notes(comparison: Comparison) -> str:
    lines = [
        "Times are medians and 95th percentiles of all runs, failed ones counting as infinite (–); Δv to capture and",
        "saturation are medians. Entries with a common letter tie.",
    ]
    short = [judged.entry.name for judged in comparison.entries if judged.score.short]
    if short:
        sentence = f"Short of the required success, hence ordered by it, after all others: {', '.join(short)}."
        lines += textwrap.wrap(sentence, 110)
    return "\n".join(lines)


def _ratios(comparison: Comparison) -> str:
    acting = comparison.scenario.disturbances.acting
    if acting:
        return f"No ratios to bounds: disturbances act ({', '.join(acting)}), and the bounds know of none."
    rows: list[tuple[str, ...]] = [
        ("over the bound of each run", "time 5 %", "median", "95 %", "Δv 5 %", "median", "95 %", "settling", "95 %")
    ]
    for place in comparison.ordered:
        judged = comparison.entries[place]
        cells = []
        for name, parts in (("time", 3), ("delta_v", 3), ("settling", 2)):
            ratio = judged.ratios.get(name)
            figures = ratio.figures if ratio else None
            three = (figures.low, figures.median, figures.high) if figures else (None, None, None)
            cells += [_number(found, 2) for found in three[-parts:]]
        rows.append((judged.entry.name, *cells))
    runs = comparison.plan.runs
    return table(rows) + (
        f"\nTime: all runs that captured; Δv: of the first {min(FUEL_RUNS, runs)} runs; settling: of the first "
        f"{min(SPREAD, runs)}."
    )


def _against(comparison: Comparison) -> str:
    """Compare the first of the order with each of the others, in the objective and in success."""
    order = comparison.ordered
    name = OBJECTIVES[comparison.plan.objective.what]
    metric = METRICS[name]
    first = comparison.entries[order[0]].entry.name
    rows: list[tuple[str, ...]] = [
        (
            f"{first} against",
            f"{metric.title}: median difference {metric.unit}",
            "95 % interval",
            "better / worse in runs",
            "p",
            f"p of {comparison.plan.objective.statistic}",
            "p of success",
        )
    ]
    for place in order[1:]:
        pair = comparison.pair(order[0], place)
        difference, sign = pair.differences[name], 1.0 if pair.places[0] == order[0] else -1.0
        counts = (difference.lower, difference.higher)
        better, worse = counts if sign > 0 else counts[::-1]
        rows.append(
            (
                comparison.entries[place].entry.name,
                _signed(sign * metric.factor * difference.median.value, metric.decimals) if difference.median else "–",
                _between(pair, name, sign * metric.factor, metric.decimals),
                f"{better} / {worse}",
                _p(pair.adjusted[name]),
                _p(pair.adjusted[STATISTIC]),
                _p(pair.adjusted["failed"]),
            )
        )
    notes = [
        "p: of better against worse; p of the statistic and of success: of these themselves; all adjusted by Holm over all pairs",
        "and tests. -inf, +inf: in most runs only one of the two succeeds.",
    ]
    return "\n".join([table(rows), *notes])


def _between(pair: Pair, metric: str, factor: float, decimals: int) -> str:
    median = pair.differences[metric].median
    if median is None or median.low is None or median.high is None:
        return "–"
    low, high = sorted((factor * median.low, factor * median.high))
    return f"{_signed(low, decimals)} … {_signed(high, decimals)}"


def _tunings(comparison: Comparison) -> str:
    objective = comparison.plan.objective
    rows: list[tuple[str, ...]] = [
        (
            f"tunings: {objective.statistic} {objective.unit}",
            "training",
            "held out",
            "others, held out",
            "success % of all",
        )
    ]
    for place in comparison.ordered:
        judged = comparison.entries[place]
        others = [tuning for index, tuning in enumerate(judged.tunings) if index != judged.chosen]
        shares = [100 * judged.verdict.success.share]
        shares += [100 * tuning.verdict.success.share for tuning in others if tuning.verdict]
        held_out = [_score(tuning.score.short, tuning.score.value) for tuning in others if tuning.score]
        rows.append(
            (
                judged.entry.name,
                _trained(judged, objective.required),
                _score(judged.score.short, judged.score.value),
                ", ".join(held_out) or "–",
                ", ".join(fixed(share, 1) for share in shares),
            )
        )
    return table(rows)


def _trained(judged: Judged, required: float) -> str:
    tuning = judged.tuning
    short = tuning.training_success is None or tuning.training_success < required
    return "short" if short else fixed(tuning.cost, 3)


def _score(short: bool, value: float) -> str:
    return "short" if short else fixed(value, 3)


def _robustness(comparison: Comparison) -> str:
    curves = comparison.entries[0].curves
    shown = [
        (index, place, curve.sweep.key, value)
        for index, curve in enumerate(curves)
        for place, value in enumerate(curve.sweep.values)
        if value in SHOWN[curve.sweep.key] and value != curve.sweep.own
    ]
    names = {"belief": "inertia x {:g}", "noise": "noise x {:g}", "control_period_s": "{:g} s"}
    rows: list[tuple[str, ...]] = [("success %", "as is", *(names[key].format(value) for _, _, key, value in shown))]
    for place in comparison.ordered:
        judged = comparison.entries[place]
        own = judged.curves[0].verdicts[judged.curves[0].sweep.values.index(judged.curves[0].sweep.own)]
        verdicts = [own, *(judged.curves[index].verdicts[at] for index, at, _, _ in shown)]
        rows.append((judged.entry.name, *(fixed(100 * verdict.success.share, 1) for verdict in verdicts)))
    runs = min(comparison.plan.robust, comparison.plan.runs)
    return table(rows) + (
        f"\nOf the first {_counted(runs, 'run')}: believed inertia, sensor noise, or control period changed, nothing tuned anew."
    )


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _second_column_left(rows: list[tuple[str, ...]]) -> str:
    """Write a table whose second column is aligned to the left too."""
    width = max(len(row[1]) for row in rows)
    return table([(f"{row[0]:>4}  {row[1]:<{width}}", *row[2:]) for row in rows])


def _number(found: Quantile | None, decimals: int, factor: float = 1.0) -> str:
    return fixed(factor * found.value if found else None, decimals)


def _signed(number: float, decimals: int) -> str:
    """Write a difference; infinite where only one of the two succeeds in most runs."""
    return f"{number:+}" if math.isinf(number) else fixed(number, decimals)


def _p(value: float) -> str:
    if value >= 0.001:
        return fixed(value, 3)
    return "<1e-300" if value == 0.0 or math.log10(value) < -300 else f"{value:.0e}"
