"""Rows → a Parquet file: what formats that are tables write with."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from sailenv_ros.dataset.formats.data_files import open_draft
from sailenv_ros.extras import need
from sailenv_ros.system.files import write_errors

__all__ = ["ROWS_PER_GROUP", "RowTable"]

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
