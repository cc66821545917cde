# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""How the library is called: who hears of the progress, on how many threads."""

from __future__ import annotations

import contextlib
import sys
import warnings
from typing import Callable, Iterator, List, Optional, Union

from . import _core

_MOST_THREADS = 4096
Progress = Union[Callable[[int, str], object], bool, None]


@contextlib.contextmanager
def calling(progress: Progress, threads: int) -> Iterator[_core.Call]:
    """A call with a function that hears of its progress, a bar (True) or nobody."""
    if not 0 <= threads <= _MOST_THREADS:
        raise ValueError(f"threads={threads}: must be from 0 (all) to {_MOST_THREADS}")
    if progress is None or progress is False:
        yield _core.Call(None, threads)
    elif callable(progress):
        yield _core.Call(progress, threads)
    else:
        with _bar() as tell:
            yield _core.Call(tell, threads)


@contextlib.contextmanager
def _bar() -> Iterator[Callable[[int, str], None]]:
    try:
        from tqdm.auto import tqdm  # type: ignore[import]
    except ImportError:
        raise ImportError("progress=True draws its bar with tqdm, which is not installed: install "
                          "it, or give a function of percent and stage") from None
    with tqdm(total=100, leave=False, bar_format="{l_bar}{bar}| {elapsed}<{remaining}") as bar:
        def tell(percent: int, stage: str) -> None:
            bar.set_description_str(stage.replace("_", " "), refresh=False)
            bar.n = percent
            bar.refresh()
        yield tell


def warn(notes: List[str]) -> None:
    """Says what a user should know though it is no error, where the package was called."""
    frame, level = sys._getframe(), 1
    while frame.f_back and frame.f_globals.get("__package__") == __package__:
        frame, level = frame.f_back, level + 1
    for note in notes:
        warnings.warn(note, UserWarning, stacklevel=level)


def meters(voxel_size: Optional[str]) -> Optional[_core.Edges]:
    """Edges of a voxel along z, y, x from a text with a unit."""
    if voxel_size is None:
        return None
    try:
        return _core.voxel_size_from_text(voxel_size)
    except _core.InvalidInput as error:
        raise _core.InvalidInput(f"voxel_size: {error}") from None


def bytes_of(max_memory: Union[int, str, None]) -> int:
    """A number of bytes, or a text with a unit, as bytes; 0 for None."""
    if max_memory is None:
        return 0
    if isinstance(max_memory, str):
        try:
            return _core.bytes_from_text(max_memory)
        except _core.InvalidInput as error:
            raise _core.InvalidInput(f"max_memory: {error}") from None
    if max_memory <= 0:
        raise ValueError(f"max_memory={max_memory}: must be above 0")
    return int(max_memory)
