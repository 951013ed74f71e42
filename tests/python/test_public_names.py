"""The names that a person finds: few at the top, and none that a module merely uses."""

from __future__ import annotations

from types import ModuleType

import pytest
import strainwave as sw

MODULES = [sw, *(member for name in sw.__all__ if isinstance(member := getattr(sw, name), ModuleType))]


def test_the_top_level_has_sixty_names_at_most() -> None:
    assert len(sw.__all__) <= 60
    assert dir(sw) == sorted(sw.__all__)


@pytest.mark.parametrize("module", MODULES, ids=lambda module: str(module.__name__))
def test_a_public_module_shows_its_own_names_alone(module: ModuleType) -> None:
    own = [name for name in dir(module) if not name.startswith("_")]
    assert own
    members = {name: getattr(module, name) for name in own}
    of_others = [name for name, member in members.items() if not _home(member, module).startswith(("strainwave", "typing"))]
    assert of_others == []
    assert "annotations" not in own


def _home(member: object, module: ModuleType) -> str:
    """Return the name of the module that defines a member; of a plain value that of the module it was found in."""
    return str(member.__name__ if isinstance(member, ModuleType) else getattr(member, "__module__", module.__name__))


def test_a_name_that_is_nearly_public_is_answered_with_that_one() -> None:
    with pytest.raises(AttributeError, match="identfy; did you mean identify"):
        _ = sw.identfy  # type: ignore[attr-defined]
    assert not hasattr(sw, "__wrapped__")
