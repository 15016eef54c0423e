"""What users read: every public function says what it owes, and its examples run."""

import doctest
import importlib
import inspect
import pkgutil

import numpy as np
import pytest
import shadelab

SKIPPED = {"shadelab.__main__"}
MODULES = [
    m.name
    for m in pkgutil.walk_packages(shadelab.__path__, "shadelab.")
    if m.name not in SKIPPED and not m.name.startswith("shadelab._kernels")
]
FACES = [n for n in MODULES if n.count(".") == 1 and not n.split(".")[1].startswith("_")]
FACES = [n for n in FACES if hasattr(importlib.import_module(n), "__all__")]


def public_callables():
    for name in FACES:
        module = importlib.import_module(name)
        for attribute in module.__all__:
            value = getattr(module, attribute)
            if callable(value) and value.__module__ and value.__module__.startswith("shadelab"):
                yield pytest.param(value, id=f"{name}.{attribute}")


@pytest.mark.parametrize("name", MODULES)
def test_examples_run(name):
    module = importlib.import_module(name)
    with np.printoptions(legacy=False, precision=8):
        result = doctest.testmod(module, optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
    assert result.failed == 0


@pytest.mark.parametrize("function", list(public_callables()))
def test_docstring_gives_what_a_technique_owes(function):
    text = inspect.getdoc(function) or ""
    assert text, "no docstring"
    if inspect.isclass(function):
        return
    parameters = [p for p in inspect.signature(function).parameters if p != "self"]
    wanted = ["Returns"] + (["Parameters", "Raises"] if parameters else [])
    missing = [s for s in wanted if f"{s}\n---" not in text and not (s == "Returns" and "Yields\n---" in text)]
    assert not missing
    named = text.split("Parameters\n---")[-1]
    assert all(p in named for p in parameters), parameters


@pytest.mark.parametrize("name", MODULES)
def test_all_names_exist(name):
    module = importlib.import_module(name)
    assert all(hasattr(module, n) for n in getattr(module, "__all__", []))
