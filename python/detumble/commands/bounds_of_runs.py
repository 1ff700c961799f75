"""`detumble bound --runs`: the bounds of many runs of a campaign, and their quantiles."""

from __future__ import annotations

from typing import TYPE_CHECKING

from detumble.tables import fixed, table

if TYPE_CHECKING:
    from pathlib import Path
    from typing import Any

    from detumble.quaternions import Array
    from detumble.scenario.model import Scenario

QUANTILES = (("min", 0.0), ("p05", 0.05), ("p50", 0.5), ("p95", 0.95), ("max", 1.0))
LABELS = {
    "capture_time_s": ("capture", "s", 2),
    "translation_s": ("translation alone", "s", 2),
    "attitude_s": ("attitude alone", "s", 2),
    "delta_v_m_s": ("Δv", "m/s", 4),
    "detumble_s": ("detumbling", "s", 2),
}
ENDINGS = {"lower": "no less than", "upper": "done in", "matched": "after a perfect match"}


def bounds_of_runs(scenario: Scenario, runs: int, seed: int, within: float | None, quick: bool) -> dict[str, Array]:
    """Bound the first runs of the campaign, with a progress line."""
    from detumble.analysis.bounds.bound import time_within
    from detumble.analysis.bounds.pursuit import Pursuit
    from detumble.analysis.bounds.runs import all_bounds, capture_bounds
    from detumble.analysis.trials import Trials
    from detumble.checking import MOST_SEED, whole
    from detumble.commands.progress import Line

    runs, seed = whole("runs", runs, 1, 10**7), whole("seed", seed, 0, MOST_SEED)
    trials = Trials(scenario, seed, 0, runs)
    until = time_within(Pursuit.of(trials.nominal("none")), within)
    with Line(None, "runs") as line:
        line.begin(runs)
        if quick:
            return {"capture_time_s.lower": capture_bounds(trials, progress=line.now)}
        return all_bounds(trials, until, progress=line.now)


def summary(values: dict[str, Array]) -> dict[str, Any]:
    """Quantiles of each bound over the runs, those that no time of the flight allows counting as infinite."""
    import numpy as np

    tables: dict[str, dict[str, Any]] = {}
    for name, bounds in values.items():
        quantity, _, end = name.partition(".")
        quantiles = np.quantile(bounds, [share for _, share in QUANTILES], method="inverted_cdf")
        table = dict(zip((name for name, _ in QUANTILES), quantiles.tolist(), strict=True))
        tables.setdefault(quantity, {})[end] = table
    return tables


def text_of_runs(scenario: Scenario, values: dict[str, Array], seed: int) -> str:
    """Write the quantiles as a table."""
    import numpy as np

    rows: list[tuple[str, ...]] = [("", "least", "5 %", "median", "95 %", "most", "never", "unit")]
    for quantity, ends in summary(values).items():
        label, unit, decimals = LABELS[quantity]
        for end, quantiles in ends.items():
            never = int(np.isinf(values[f"{quantity}.{end}"]).sum())
            cells = (fixed(value, decimals) for value in quantiles.values())
            rows.append((f"{label}, {ENDINGS[end]}", *cells, str(never) if never else "–", unit))
    runs = len(next(iter(values.values())))
    return "\n".join([scenario.title, f"bounds of {runs} runs, seed {seed}", "", table(rows)])


def write_runs(scenario: Scenario, values: dict[str, Array], out: Path) -> list[Path]:
    """Write a row for each run, under its index in the campaign, and the scenario."""
    import io

    import numpy as np
    import polars as pl

    from detumble.writing import write_bytes, write_text

    files = [out / "bounds.parquet", out / "scenario.toml"]
    index = np.arange(len(next(iter(values.values()))), dtype=np.uint64)
    content = io.BytesIO()
    pl.DataFrame({"index": index, **values}).write_parquet(content)
    write_bytes(files[0], content.getbuffer())
    write_text(files[1], scenario.to_toml())
    return files
