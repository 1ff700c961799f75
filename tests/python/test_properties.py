"""Any input of the scenario reader, `--set`, dispersions and the API: a documented exception, or a scenario that flies."""

from __future__ import annotations

import contextlib
import copy
import tomllib
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import detumble
from detumble.campaigns.runs.draws import draw
from detumble.errors import RequestError
from detumble.scenario import Scenario, from_toml, with_settings
from detumble.scenario.dispersions import DISTRIBUTIONS
from detumble.scenario.dispersions.fitting import fields
from detumble.scenario.toml import literal

QUICK = settings(
    max_examples=200, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True, database=None
)

texts = st.text(max_size=20)
numbers = st.one_of(st.floats(), st.integers(), st.sampled_from([0.0, -0.0, 1.0, 0.1, 1e-9, 1e300]))
plain = st.recursive(
    st.one_of(st.none(), st.booleans(), numbers, texts, st.binary(max_size=5)),
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(texts, inner, max_size=3)),
    max_leaves=8,
)
"""Anything that a file or a caller may give."""


@cache
def paper() -> Scenario:
    return with_settings(detumble.load("paper"), ["time.duration=1.0"])


def paths(table: dict[str, Any], prefix: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    found = []
    for name, value in table.items():
        found.append((*prefix, name))
        if isinstance(value, dict):
            found += paths(value, (*prefix, name))
    return found


PATHS = paths(paper().to_dict())


def flies(scenario: Scenario, law: str) -> None:
    """Make sure that what was accepted can be written, read back and flown, if it is not too long."""
    assert from_toml(scenario.to_toml()) == scenario
    if scenario.time.duration / scenario.time.control_period > 1000:
        return
    flight = detumble.simulate(scenario, law)
    assert len(flight.history["time"]) or flight.diverged


@QUICK
@given(path=st.sampled_from(PATHS), value=plain, law=st.sampled_from(detumble.LAWS))
def test_a_file_with_one_wrong_value_is_refused_or_flies(path: tuple[str, ...], value: Any, law: str) -> None:
    raw = copy.deepcopy(paper().to_dict())
    table = raw
    for name in path[:-1]:
        table = table[name]
    table[path[-1]] = value
    try:
        scenario = detumble.scenario.faults.validated(raw, "raw")  # type: ignore[attr-defined]
        flies(scenario, law)
    except RequestError:
        pass


@QUICK
@given(text=st.one_of(st.text(max_size=200), st.binary(max_size=200).map(lambda raw: raw.decode("latin-1"))))
def test_any_text_is_refused(text: str) -> None:
    with pytest.raises(RequestError, match=r"^scenario: "):
        from_toml(text)


@QUICK
@given(
    path=st.one_of(st.sampled_from([".".join(path) for path in PATHS]), st.text(max_size=12)),
    value=st.one_of(st.text(max_size=20), numbers.map(str), st.lists(numbers, max_size=4).map(str)),
    law=st.sampled_from(detumble.LAWS),
)
def test_any_setting_is_refused_or_flies(path: str, value: str, law: str) -> None:
    with contextlib.suppress(RequestError):
        flies(with_settings(paper(), [f"{path}={value}"]), law)


@QUICK
@given(
    field=st.one_of(st.sampled_from(sorted(fields())), texts),
    distribution=st.one_of(st.sampled_from(sorted(DISTRIBUTIONS)), texts),
    parameters=st.dictionaries(
        st.sampled_from(["sigma", "relative", "mean", "low", "high", "cone_deg", "magnitude", "axes_sigma", "axes"]),
        st.one_of(numbers, st.floats(0.0, 1.0), st.lists(st.floats(0.0, 1.0), min_size=3, max_size=3), texts),
        max_size=3,
    ),
)  # fmt: skip
def test_any_dispersion_is_refused_or_draws_within_its_field(
    field: str, distribution: str, parameters: dict[str, Any]
) -> None:
    raw = copy.deepcopy(paper().to_dict())
    raw["dispersions"] = [{"field": field, "distribution": distribution, **parameters}]
    try:
        scenario = detumble.scenario.faults.validated(raw, "raw")  # type: ignore[attr-defined]
    except RequestError:
        return
    for values in draw(scenario, 1, 0, 20).values():
        assert np.isfinite(values).all()
    assert len(detumble.campaign(scenario, "pd", 3).runs) == 3


@QUICK
@given(seed=plain, index=plain, law=plain, backend=plain)
def test_any_argument_of_a_flight_is_refused_or_flies(seed: Any, index: Any, law: Any, backend: Any) -> None:
    for arguments in ({"seed": seed}, {"index": index}, {"law": law}, {"backend": backend}):
        try:
            flight = detumble.simulate(paper(), **arguments)
        except RequestError:
            continue
        assert flight.law in (*detumble.LAWS, "none")


@QUICK
@given(
    value=st.recursive(
        st.one_of(st.booleans(), st.floats(allow_nan=False), st.integers(), texts), lambda x: st.lists(x, max_size=3)
    )
)
def test_what_is_written_as_toml_is_read_as_it_was(value: Any) -> None:
    assert tomllib.loads(f"value = {literal(value)}")["value"] == value
