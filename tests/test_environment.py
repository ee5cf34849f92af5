"""The places that say what the course needs agree: pyproject.toml, environment.yml, the Makefile, CI."""

import os
import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name
from packaging.version import Version

ROOT = Path(__file__).parents[1]
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))

#: Where conda-forge has another name than PyPI.
NAME_ON_PYPI = {"playwright-python": "playwright"}

Needs = dict[str, SpecifierSet]


@pytest.fixture(scope="module")
def project():
    return PYPROJECT["project"]


@pytest.fixture(scope="module")
def environment():
    return yaml.safe_load((ROOT / "environment.yml").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def job():
    workflow = yaml.safe_load((ROOT / ".github/workflows/test.yml").read_text(encoding="utf-8"))
    return workflow["jobs"]["test"]


def needs(lines: list[str]) -> Needs:
    """Read requirements into a table from PyPI's name to the versions that are allowed."""
    table: Needs = {}
    for requirement in map(Requirement, lines):
        name = canonicalize_name(requirement.name)
        name = NAME_ON_PYPI.get(name, name)
        assert name not in table, f"{name} is listed twice"
        table[name] = requirement.specifier
    return table


def conda_needs(environment) -> Needs:
    return needs([line for line in environment["dependencies"] if isinstance(line, str)])


def supported_pythons(project) -> list[str]:
    prefix = "Programming Language :: Python :: "
    return [line.removeprefix(prefix) for line in project["classifiers"] if line.startswith(prefix)]


def make_steps(*targets: str) -> list[str]:
    """The commands of Makefile targets, without the folder of the virtual environment."""
    variables = dict(re.findall(r"^([A-Z_]+) = (.*)$", MAKEFILE, flags=re.MULTILINE))
    steps = []
    for target in targets:
        (recipe,) = re.findall(rf"^{target}:.*\n((?:\t.*\n)+)", MAKEFILE, flags=re.MULTILINE)
        for line in recipe.splitlines():
            step = line.strip()
            while "$(" in step:
                step = re.sub(r"\$\((\w+)\)", lambda name: variables[name[1]], step)
            steps.append(step.replace(".venv/bin/", ""))
    return steps


def make(*arguments: str, folder: Path = ROOT) -> subprocess.CompletedProcess[str]:
    if shutil.which("make") is None:
        pytest.skip("there is no make here")
    # These tests may run inside `make test`, whose options must not reach them.
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith(("MAKE", "MFLAGS"))
    }
    return subprocess.run(
        ["make", *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def test_conda_installs_what_pip_installs(project, environment):
    extras = dict(project["optional-dependencies"])
    pip = needs([*project["dependencies"], *extras.pop("test")])
    for name in needs([line for lines in extras.values() for line in lines]):
        pip.pop(name, None)  # one that the tests have too is named in a comment, as pip installs it
    conda = conda_needs(environment)
    assert conda.pop("pip") == SpecifierSet()
    del conda["python"]
    assert conda == pip


def test_what_may_be_installed_besides_is_named_for_conda_too(project):
    extras = [
        line for name, lines in project["optional-dependencies"].items() if name != "test" for line in lines
    ]
    assert extras
    text = (ROOT / "environment.yml").read_text(encoding="utf-8")
    for line in extras:
        assert re.search(rf'# not needed, for .+: pip install "{re.escape(line)}"', text)


def test_conda_installs_the_course_itself_from_this_folder_and_nothing_else_with_pip(environment):
    (pip,) = [line["pip"] for line in environment["dependencies"] if isinstance(line, dict)]
    assert pip == ["-e ."]
    assert environment["name"] == "gpcourse"
    assert environment["channels"] == ["conda-forge"]


def test_jsonschema_stays_below_the_release_that_makes_nbformat_slow(project):
    assert not needs(project["dependencies"])["jsonschema"].contains("4.25")


def test_the_oldest_python_is_the_same_everywhere(project, environment):
    oldest, *_ = supported_pythons(project)
    assert project["requires-python"] == f">={oldest}"
    assert PYPROJECT["tool"]["mypy"]["python_version"] == oldest
    assert PYPROJECT["tool"]["ruff"]["target-version"] == "py" + oldest.replace(".", "")
    wanted = ", ".join(oldest.split("."))
    assert f"sys.version_info < ({wanted})" in MAKEFILE


def test_conda_and_ci_use_exactly_the_pythons_that_are_promised(project, environment, job):
    promised = supported_pythons(project)
    assert job["strategy"]["matrix"]["python"] == promised
    assert promised == sorted(promised, key=Version)
    allowed = conda_needs(environment)["python"]
    minors = [f"3.{minor}" for minor in range(8, 30)]
    assert [python for python in minors if allowed.contains(python + ".1")] == promised


def test_ci_runs_on_three_systems(job):
    systems = [name.partition("-")[0] for name in job["strategy"]["matrix"]["os"]]
    assert sorted(systems) == ["macos", "ubuntu", "windows"]


def test_ci_pins_every_action_to_a_major_version(job):
    actions = [step["uses"] for step in job["steps"] if "uses" in step]
    assert actions
    for action in actions:
        assert re.fullmatch(r"actions/[\w-]+@v\d+", action), action


def test_on_windows_ci_runs_the_steps_of_make_test(job):
    (windows,) = [step["run"] for step in job["steps"] if step.get("name") == "The steps of make test"]
    (targets,) = re.findall(r"^test: ([a-z ]+) ##", MAKEFILE, flags=re.MULTILINE)
    assert windows.splitlines() == make_steps(*targets.split())


def test_every_check_that_is_promised_is_a_step_of_make_test():
    steps = make_steps("lint", "nbval", "pytest")
    for tool in ("ruff check", "ruff format --check", "mypy", "gpcourse solve"):
        assert any(step.startswith(tool) for step in steps), tool
    assert sum("--nbval-lax" in step for step in steps) == 2


def test_make_alone_lists_every_target():
    (phony,) = re.findall(r"^\.PHONY: (.*)$", MAKEFILE, flags=re.MULTILINE)
    listed = re.findall(r"^make ([a-z]+) +\S", make().stdout, flags=re.MULTILINE)
    assert listed == phony.split()


def test_make_refuses_an_old_python_and_says_what_to_do(tmp_path):
    old = tmp_path / "python3"
    old.write_text("#!/bin/sh\nexit 1\n", encoding="utf-8")
    old.chmod(0o755)
    venv = tmp_path / "venv"
    seen = make(
        "-f", str(ROOT / "Makefile"), f"VENV={venv}", f"PYTHON={old}", f"{venv}/pyvenv.cfg", folder=tmp_path
    )
    assert seen.returncode == 2
    assert "needs Python 3.11 or newer" in seen.stderr
    assert "PYTHON=/path/to/python" in seen.stderr
    assert not venv.exists()
