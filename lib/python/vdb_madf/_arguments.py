# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Arguments of wrong types are refused in a line that names them."""

from __future__ import annotations

import collections.abc
import functools
import inspect
import operator
import os
import re
import typing
from typing import Any, Callable, Dict, TypeVar, Union

import numpy as np

from . import _core
from ._arrays import ArrayLike3D, shown

_Function = TypeVar("_Function", bound=Callable[..., Any])

_NAMES: Dict[Any, str] = {
    bool: "True or False", int: "a whole number", float: "a number", str: "a text",
    slice: "a slice", ArrayLike3D: "an array [z, y, x]"}

#: What is hard to guess from a type.
_EXAMPLES = {
    "voxel_size": ", with its unit, such as '8.5um'", "max_memory": ", such as '12GiB'",
    "threshold": ", such as 128, 'otsu' or (100, 120)", "range": ", such as (100, 180)",
    "crop": ", such as numpy.s_[10:90, :, 5:50]", "domain": ", such as numpy.s_[0:90, 0:90, 0:50]",
    "roi": ", such as 'cylinder'", "aspect": ", such as (4, 8)"}


def checked(function: _Function) -> _Function:
    """The function, which refuses arguments of other types than its signature has."""
    signature = inspect.signature(function)

    @functools.wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        try:
            given = signature.bind(*args, **kwargs).arguments
        except TypeError:
            given = {}  # the call itself says it better
        refuse_wrong_types(function, given)
        try:
            return function(*args, **kwargs)
        except TypeError as error:
            far = _beyond_the_library(given)
            if "incompatible function arguments" not in str(error) or not far:
                raise
            raise _core.InvalidInput(f"{far}: is out of range") from None

    return typing.cast(_Function, call)


def refuse_wrong_types(of: Any, given: Dict[str, Any]) -> None:
    """Of arguments of a function, or fields of a class."""
    hints = _hints(of)
    for name, value in given.items():
        if name in hints and not _fits(value, hints[name]):
            raise TypeError(f"{name}={shown(value)}: give {_wanted(hints[name])}"
                            f"{_EXAMPLES.get(name, '')}")


@functools.lru_cache(maxsize=None)
def _hints(of: Any) -> Dict[str, Any]:
    return typing.get_type_hints(of)


def _beyond_the_library(given: Dict[str, Any]) -> str:
    """Numbers that are whole, but perhaps larger or smaller than the library takes."""
    return ", ".join(f"{name}={value}" for name, value in given.items()
                     if isinstance(value, int) and not 0 <= value < 2**31)


def _fits(value: Any, hint: Any) -> bool:
    origin, parts = typing.get_origin(hint), typing.get_args(hint)
    if origin is Union:
        return any(_fits(value, part) for part in parts)
    if hint is bool:
        return isinstance(value, (bool, np.bool_))
    if hint is int:
        return not isinstance(value, (bool, np.bool_)) and is_index(value)
    if hint is float:
        return (hasattr(value, "__float__") and not isinstance(value, (bool, np.bool_))
                and getattr(value, "ndim", 0) == 0)
    if hint is ArrayLike3D:
        return isinstance(value, (list, tuple)) or hasattr(value, "shape")
    if origin is tuple:
        return are_items(value) and len(value) == len(parts) and all(map(_fits, value, parts))
    if origin is collections.abc.Sequence:
        return are_items(value) and all(_fits(item, parts[0]) for item in value)
    if origin is collections.abc.Callable:
        return callable(value)
    kind = origin or hint
    if kind is np.ndarray and isinstance(value, np.ndarray) and _number(hint) is not Any:
        return value.ndim == 1 and np.issubdtype(value.dtype, _number(hint))
    return not isinstance(kind, type) or isinstance(value, kind)


def _number(hint: Any) -> Any:
    """The type of the numbers of an array, or Any."""
    number, = typing.get_args(typing.get_args(hint)[1])
    return typing.get_origin(number) or number


def is_index(value: Any) -> bool:
    try:
        operator.index(value)
    except TypeError:
        return False
    return True


def are_items(value: Any) -> bool:
    return (isinstance(value, collections.abc.Collection)
            and not isinstance(value, (str, bytes, collections.abc.Mapping))
            and getattr(value, "ndim", 1) > 0)


def _wanted(hint: Any, many: bool = False) -> str:
    """The type in words: "a number or two numbers". Where a path is taken, a text is one."""
    origin, parts = typing.get_origin(hint), typing.get_args(hint)
    kind = origin or hint
    if origin is Union:
        hides = (type(None), str if os.PathLike in map(typing.get_origin, parts) else None)
        words = [_wanted(part, many) for part in parts if part not in hides]
        return ", ".join(words[:-1]) + " or " + words[-1] if len(words) > 1 else words[0]
    if origin is tuple:
        return f"{('no', 'one', 'two', 'three')[len(parts)]} {_wanted(parts[0], True)}"
    if origin is collections.abc.Sequence:
        text = f"a list of {_wanted(parts[0], True)}"
    elif origin is collections.abc.Callable:
        text = "a function"
    elif kind is np.ndarray:
        text = "an array" if _number(hint) is Any else "an array of whole numbers"
    else:
        text = _NAMES.get(kind) or (
            "a path" if kind is os.PathLike else getattr(kind, "__name__", str(kind)))
    return re.sub(r"^an? (.*?)( of | \[|$)", r"\1s\2", text) if many else text
