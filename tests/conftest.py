import hypothesis
import pytest

# No deadline: the first example of a kernel pays for its compilation.
# Derandomized: the tests do the same in every run.
hypothesis.settings.register_profile("suite", deadline=None, derandomize=True, print_blob=True)
hypothesis.settings.load_profile("suite")

LONGEST = ("test_recipes.py", "test_docs.py", "test_guide.py", "test_arbiter.py")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files that take a minute begin first: at the end all processes but one would wait for them."""
    items.sort(key=lambda item: LONGEST.index(item.path.name) if item.path.name in LONGEST else len(LONGEST))
