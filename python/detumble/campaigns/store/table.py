"""The table of all runs of a campaign, read back from its shards."""

from __future__ import annotations

from bisect import bisect_left
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

from detumble.campaigns.columns import FAILURE
from detumble.campaigns.store.shard import CAUSE, KINDS, Damage, codes, column, rows_in, values
from detumble.errors import RequestError
from detumble.failures import CAUSES
from detumble.surroundings import check_dask, check_polars

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]
    from numpy.typing import NDArray

    from detumble.campaigns.store.campaign_folder import Store


class Runs:
    """The runs of a campaign from the first on, without a gap; each is read from its shard when it is asked for.

    The ends of all files are checked here; what they hold is checked by `Store.shard`.

    Args:
        store: the campaign.
        runs: how many; None for all that were asked of the campaign.

    Raises:
        RequestError: some of these runs are not there.
    """

    def __init__(self, store: Store, runs: int | None = None) -> None:
        self._store = store  # keeps a temporary folder alive
        self._recipe = store.recipe
        self._runs = store.runs if runs is None else runs
        self._paths = [store.path(index) for index in range(self._recipe.shards(self._runs))]
        faults = {index: fault for index in range(len(self._paths)) if (fault := self._fault(index))}
        if faults:
            whole = min(faults) * self._recipe.shard
            listed = [f"shard {index} {fault}" for index, fault in list(faults.items())[:3]]
            listed += [f"and {len(faults) - 3} more shards"] if len(faults) > 3 else []
            raise RequestError(
                f"{store.folder}: of {self._runs} runs only the first {whole} can be read: {', '.join(listed)}; "
                "--resume flies what is missing"
            )

    def _fault(self, index: int) -> str:
        try:
            rows = rows_in(self._paths[index], self._recipe.identity, index)
        except FileNotFoundError:
            return "is missing"
        except Damage as why:
            return f"is damaged ({why})"
        needed = len(self._recipe.runs_of(index, self._runs))
        return f"has {rows} of {needed} runs" if rows < needed else ""

    def __len__(self) -> int:
        return self._runs

    def lazy(self) -> pl.LazyFrame:
        """Give the table, ordered by `index`, for queries that read only what they need."""
        check_polars()
        return pl.scan_parquet(self._paths, glob=False).head(self._runs)

    def to_polars(self) -> pl.DataFrame:
        """Read the whole table; what did not happen is null."""
        return self.lazy().collect()

    def to_pandas(self) -> pd.DataFrame:
        """Read the whole table; what did not happen is NaN, and `failure` is a categorical."""
        import pandas as pd

        table = self.to_polars()
        causes = pd.Categorical.from_codes(codes(table[FAILURE.name]), categories=list(CAUSES))
        return pd.DataFrame(
            {series.name: causes if series.name == FAILURE.name else values(series) for series in table}
        )

    def to_xarray(self) -> xr.Dataset:
        """Give the table as a dataset over `run`, with units and long names; a variable is read when its values are used."""
        check_dask()
        variables = {
            name: xr.Variable("run", indexing.LazilyIndexedArray(self._stored(name, dtype)), _attributes(name, dtype))
            for name, dtype in self.lazy().collect_schema().items()
        }
        attributes = {
            "title": self._recipe.parsed.title,
            "law": self._recipe.law,
            "seed": str(self._recipe.seed),
            "detumble_version": self._recipe.version,
            "shard": self._recipe.shard,
            "scenario": self._recipe.scenario,
        }
        return xr.Dataset(variables, attrs=attributes)

    def _stored(self, name: str, dtype: pl.DataType) -> _StoredColumn:
        kind = np.dtype(object if dtype == CAUSE else KINDS[dtype])
        return _StoredColumn(name, kind, self._store, self._runs)


def _attributes(name: str, dtype: pl.DataType) -> dict[str, str]:
    card = column(name)
    unit = card.unit or ("1" if dtype == pl.Float64 else "")
    return {"long_name": card.meaning} | ({"units": unit} if unit else {})


class _StoredColumn(BackendArray):
    """One column of the table, (runs,): of the shards only those are read that hold what is asked for."""

    def __init__(self, name: str, dtype: np.dtype[Any], store: Store, runs: int) -> None:
        self.name, self.dtype, self.shape = name, dtype, (runs,)
        self._store, self._rows = store, store.recipe.shard

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER, self._asked)

    def _asked(self, key: tuple[Any, ...]) -> Any:
        (asked,) = key
        if isinstance(asked, slice):
            return self._read(range(self.shape[0])[asked])
        return self._read(asked) if isinstance(asked, np.ndarray) else self._read([asked])[0]

    def _read(self, positions: range | list[int] | NDArray[np.intp]) -> NDArray[Any]:
        """Read the values at increasing positions."""
        check_polars()
        read = np.empty(len(positions), self.dtype)
        shards = range(positions[0] // self._rows, positions[-1] // self._rows + 1) if len(positions) else ()
        for index in shards:
            first = index * self._rows
            low, high = bisect_left(positions, first), bisect_left(positions, first + self._rows)
            if low < high:
                stored = pl.read_parquet(self._store.path(index), columns=[self.name], glob=False)
                read[low:high] = values(stored[self.name])[np.asarray(positions[low:high]) - first]
        return read
