"""Names that other programs may rely on stand in docs/interfaces.md, and those that stand there exist."""

import os
import re
from pathlib import Path

import isowave

SOURCE = Path(os.environ["ISOWAVE_SOURCE"])


SHARED = ("points", "triangles")  # of all that have a mesh


def names_of(text):
    """`a`, `B.c` of the first column of the tables in the section "Python"."""
    section = text.split("\n## Python\n", 1)[1].split("\n## ", 1)[0]
    cells = [line.split("|")[1] for line in section.splitlines() if line.startswith("| `")]
    return {name for cell in cells for name in re.findall(r"`([A-Za-z_.0-9]+)", cell)}


def names_there_are():
    names = set()
    for name in set(isowave.__all__) - {"__version__"}:
        names.add(name)
        thing = getattr(isowave, name)
        if isinstance(thing, type) and not issubclass(thing, Exception):
            own = vars(thing) if not hasattr(thing, "_fields") else dict.fromkeys(thing._fields)
            names |= {f"{name}.{member}" for member in own if not member.startswith("_")}
            names |= {f"{name}.{to}" for to in dir(thing) if to.startswith("to_") or (hasattr(thing, "to_vtk") and to in SHARED)}
    return names


def test_the_page_and_the_module_have_the_same_names():
    page = names_of((SOURCE / "docs/interfaces.md").read_text())
    assert page - names_there_are() == set(), "in docs/interfaces.md only"
    assert names_there_are() - page == set(), "missing in docs/interfaces.md"


def test_everything_has_a_docstring_and_functions_have_an_example():
    for name in set(isowave.__all__) - {"__version__"}:
        thing = getattr(isowave, name)
        assert thing.__doc__ and not thing.__doc__.startswith(name + "("), name
        if callable(thing) and not isinstance(thing, type):
            assert ">>>" in thing.__doc__ and "Raises" in thing.__doc__, name


def test_the_version_is_that_of_the_library():
    header = (SOURCE / "include/isowave/version.h").read_text()
    assert f'"{isowave.__version__}"' in header
