"""What tests of several rooms share."""

import os
import sys
from pathlib import Path

import pytest

# Tests in this process solve as most students do, without the extra `cholmod`: an import of it fails.
# Notebooks that are run and the workers of the grader have it. The tests of the factorisations bring it back.
sys.modules["cholespy"] = None


@pytest.fixture(scope="session")
def real() -> Path:
    """The folder of real scans and meshes, made by others and not part of the project."""
    folder = Path(os.environ.get("GPCOURSE_REAL") or Path(__file__).parents[2] / "shared" / "real")
    if not folder.is_dir():
        pytest.skip(f"no real meshes in {folder}; set GPCOURSE_REAL to the folder that has them")
    return folder
