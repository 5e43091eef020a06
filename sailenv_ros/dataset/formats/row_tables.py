"""Rows → a Parquet file: what formats that are tables write with."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, ClassVar

from sailenv_ros.dataset.formats.data_files import discard_drafts, open_draft
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record
from sailenv_ros.extras import need
from sailenv_ros.system.files import write_errors

__all__ = ["ROWS_PER_GROUP", "RowTable", "TableFormat"]

ROWS_PER_GROUP = 32
"""Number of rows that are kept in memory, and read at once for any one of them."""


class RowTable:
    """A Parquet file to which rows are appended.

    Parameters
    ----------
    drafts : ExitStack
        The file takes its place when this is closed well.
    path : Path
        Of the file; its folder is made.
    schema : pyarrow.Schema

    Raises
    ------
    RecordingError
        If the file cannot be written.
    """

    def __init__(self, drafts: ExitStack, path: Path, schema: Any) -> None:
        self._table: Any = need("pyarrow", f"{path.name}").Table
        self._path = path
        self._schema = schema
        self._rows: list[Mapping[str, Any]] = []
        file = open_draft(drafts, path)
        parquet: Any = need("pyarrow.parquet", f"{path.name}")
        self._writer = parquet.ParquetWriter(file, schema, compression="zstd")

    def append(self, row: Mapping[str, Any]) -> None:
        """Append one row.

        Raises
        ------
        RecordingError
            If the file cannot be written.
        """
        self._rows.append(row)
        if len(self._rows) == ROWS_PER_GROUP:
            self._flush()

    def finish(self) -> None:
        """Write what is left; the file's owner closes it.

        Raises
        ------
        RecordingError
            If the file cannot be written.
        """
        self._flush()
        self._writer.close()

    def _flush(self) -> None:
        rows, self._rows = self._rows, []
        if rows:
            table = self._table.from_pylist(rows, schema=self._schema)
            with write_errors(self._path):
                self._writer.write_table(table)


class TableFormat(DatasetFormat):
    """A format of ``data/<split>-00000.parquet``: one for each split, or for each shard."""

    is_shard: ClassVar[bool] = True
    resumable: ClassVar[bool] = False
    packages: ClassVar[tuple[str, ...]] = ("pyarrow",)

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._arrow: Any = need("pyarrow", "a format that is a table")
        self._open = ExitStack()
        self._tables: dict[str, RowTable] = {}

    def finish(self, records: Sequence[Record]) -> None:
        """Write what is left and close the files."""
        for table in self._tables.values():
            table.finish()
        self._tables.clear()
        self._open.close()

    def close(self) -> None:
        """Remove what is not complete."""
        self._tables.clear()
        discard_drafts(self._open)

    def _table(self, split: str, schema: Callable[[], Any]) -> RowTable:
        """Return the table of a split, whose columns a function tells once."""
        name = split or "train"
        if name not in self._tables:
            path = self.folder / "data" / f"{name}-{self.part:05d}.parquet"
            self._tables[name] = RowTable(self._open, path, schema())
        return self._tables[name]
