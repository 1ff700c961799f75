"""The file of a shard: rows as Parquet, checked to the bit, readable by anything that reads Parquet.

Its key-value metadata name the campaign's identity, the shard, its first run, its rows, and units and meanings of its columns
(JSON, by name); `digest` hashes the rows alone, whatever the compression, and `checksum` all bytes of the file. NaN, which
stands for what did not happen, is null.
"""

from __future__ import annotations

import hashlib
import io
import json
import re
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from detumble.campaigns.columns import FAILURE, INDEX, RESULTS, Column
from detumble.failures import CAUSES
from detumble.scenario.model import Scenario
from detumble.scenario.reflection import quantity_of, section_at
from detumble.surroundings import check_polars
from detumble.writing import reason

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

CAUSE = pl.Enum(CAUSES)
KINDS = {pl.Float64(): "float64", pl.UInt64(): "uint64", pl.UInt8(): "uint8", pl.Boolean(): "bool", CAUSE: "cause"}
"""Types of columns, and what the digest calls them."""
_END = 8
"""A Parquet file ends with its footer, the footer's length in 4 bytes, and `PAR1`."""
_BLANK = b"?" * 64
_CHECKSUM = re.compile(rb"blake2b:([0-9a-f?]{64})([0-9a-f?]{64})")
"""Of what stands before the footer, and of the footer with this second part blank."""


class Damage(Exception):
    """Why the file of a shard cannot be used."""


@cache
def column(name: str) -> Column:
    """Find unit and meaning of a column.

    Args:
        name: of `columns.INDEX`, `columns.RESULTS`, or the path of a drawn field: `chaser.mass`, `chaser.position.x`.

    Raises:
        ValueError: there is no such column.
    """
    for fixed in (INDEX, *RESULTS):
        if fixed.name == name:
            return fixed
    for path in (name, name.rpartition(".")[0]):
        *owners, last = path.split(".")
        section = section_at(Scenario, tuple(owners))
        field = section.model_fields.get(last) if section else None
        quantity = quantity_of(field) if field else None
        if quantity:
            return Column(name, quantity.unit, f"{name}: {quantity.meaning}")
    raise ValueError(f"column {name!r}: neither a result of a run nor a quantity of a scenario")


def frame_of(columns: Mapping[str, NDArray[Any] | Sequence[str | None]]) -> pl.DataFrame:
    """Make rows of columns.

    Args:
        columns: arrays of one length (n,): float64, uint64, uint8 or bool; under `failure` texts out of `CAUSES`, or None.

    Raises:
        ValueError: a column of another type.
    """
    check_polars()
    frame = pl.DataFrame([_series(name, values) for name, values in columns.items()])
    for name, dtype in frame.schema.items():
        if dtype not in KINDS:
            raise ValueError(f"column {name!r}: {dtype} is none of {', '.join(KINDS.values())}")
    return frame


def _series(name: str, values: NDArray[Any] | Sequence[str | None]) -> pl.Series:
    if name == FAILURE.name:
        return pl.Series(name, values, dtype=CAUSE)
    return pl.Series(name, np.ascontiguousarray(values), nan_to_null=True)


def digest(frame: pl.DataFrame) -> str:
    """Hash names, types and values of the columns, bit by bit: BLAKE2b, 64 hexadecimal digits. Every NaN is the same."""
    hashed = hashlib.blake2b(digest_size=32)
    for series in frame:
        hashed.update(json.dumps([series.name, KINDS[series.dtype], len(series)]).encode())
        bits = codes(series) if series.dtype == CAUSE else values(series)
        hashed.update(np.ascontiguousarray(bits).data)
    return hashed.hexdigest()


def values(series: pl.Series) -> NDArray[Any]:
    """Give a column as an array (n,): NaN for null, causes as texts or None."""
    if series.dtype == CAUSE:
        return np.array([*CAUSES, None], dtype=object)[codes(series)]
    return (series.fill_null(float("nan")) if series.dtype == pl.Float64 else series).to_numpy()


def codes(failures: pl.Series) -> NDArray[np.int8]:
    """Give failures as their places in `CAUSES`, -1 for a success."""
    return failures.to_physical().cast(pl.Int8).fill_null(-1).to_numpy()


def encode(frame: pl.DataFrame, campaign: str, index: int, first: int) -> bytes:
    """Write rows as the file of a shard; equal rows give equal bytes.

    Args:
        frame: the rows.
        campaign: identity of the campaign.
        index: of the shard.
        first: index of the first run.
    """
    check_polars()
    label = {
        "campaign": campaign,
        "shard": str(index),
        "first": str(first),
        "rows": str(frame.height),
        "units": json.dumps({name: column(name).unit for name in frame.columns}),
        "meanings": json.dumps({name: column(name).meaning for name in frame.columns}, ensure_ascii=False),
        "digest": digest(frame),
        "checksum": f"blake2b:{2 * _BLANK.decode()}",
    }
    buffer = io.BytesIO()
    frame.write_parquet(buffer, compression="zstd", compression_level=1, metadata=label)
    raw = buffer.getvalue()
    start = len(raw) - _footer_length(raw[-_END:], len(raw))
    footer = raw[start:].replace(2 * _BLANK, _hash(raw[:start]) + _BLANK)
    return raw[:start] + footer.replace(_BLANK, _hash(footer))


def decode(raw: bytes, campaign: str, index: int, first: int) -> pl.DataFrame:
    """Read the file of a shard, and make sure that it is whole, sound and the right one.

    Args:
        raw: the file.
        campaign: identity of the campaign.
        index: of the shard.
        first: index of the first run.

    Returns:
        The rows.

    Raises:
        Damage: anything is not as it was written.
    """
    check_polars()
    start = len(raw) - _footer_length(raw[-_END:], len(raw))
    label = _label(raw[start:], campaign, index)
    # before polars reads it: some flipped bits make its reader abort the process
    if label["checksum"].encode()[-128:-64] != _hash(raw[:start]):
        raise Damage("its bytes are not those that were written")
    frame = pl.read_parquet(raw)
    if digest(frame) != label["digest"]:
        raise Damage("its rows are not those that were written")
    if not np.array_equal(frame[INDEX.name], np.arange(first, first + frame.height, dtype=np.uint64)):
        raise Damage(f"its rows are not the runs from {first} on")
    return frame


def rows_in(path: Path, campaign: str, index: int) -> int:
    """Count the rows of a shard by the end of its file, which is checked; the rows themselves are not read.

    Raises:
        Damage: the end of the file is not as it was written, or that of another shard.
        FileNotFoundError: there is no such file.
    """
    if path.exists() and not path.is_file():
        raise Damage("is no regular file")
    try:
        with path.open("rb") as file:
            size = file.seek(0, io.SEEK_END)
            file.seek(max(0, size - _END))
            file.seek(size - _footer_length(file.read(), size))
            return int(_label(file.read(), campaign, index)["rows"])
    except FileNotFoundError:
        raise
    except OSError as error:
        raise Damage(f"cannot be read: {reason(error)}") from None


def _footer_length(end: bytes, size: int) -> int:
    length = int.from_bytes(end[:4], "little") + _END
    if end[4:] != b"PAR1" or length > size:
        raise Damage("cut off, or no Parquet file")
    return length


def _label(footer: bytes, campaign: str, index: int) -> dict[str, str]:
    found = _CHECKSUM.search(footer)
    if not found or found[2] != _hash(footer.replace(found[2], _BLANK)):
        raise Damage("the end of the file is not as it was written")
    label = pl.read_parquet_metadata(io.BytesIO(footer))
    if label["campaign"] != campaign:
        raise Damage("belongs to another campaign")
    if label["shard"] != str(index):
        raise Damage(f"is shard {label['shard']} under another's name")
    return label


def _hash(content: bytes) -> bytes:
    return hashlib.blake2b(content, digest_size=32).hexdigest().encode()
