"""Fixtures that every part of the tests may use."""

import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

# as the command does (`sysid.cli.app`): threads of BLAS only fight with those of JAX
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Half of the time of the tests is compiling: as commands do that need many programs for seconds
# (`sysid.cli.compile_cache`)
os.environ.setdefault("XLA_FLAGS", "--xla_cpu_use_fusion_emitters=false")

import numpy as np
import pytest

REPOSITORY = Path(__file__).resolve().parents[1]
LONG = (
    "tests/trials/test_slice.py", "tests/diagnosis/test_last_resort.py",
    "tests/cli/test_fit_sweep.py", "tests/cli/test_fit_posterior.py",
    "tests/recovery/test_temperature_laws.py", "tests/diagnosis/test_invariance.py",
    "tests/cli/test_fit.py", "tests/recovery/test_w11_joined.py",
    "tests/diagnosis/test_within_tests.py", "tests/trials/test_poor.py",
    "tests/notebooks/test_notebooks.py", "tests/structure/test_blocks.py",
    "tests/isolator/test_lumped_beside.py",
)  # fmt: skip
"""Files that take a minute and more: first, or the last of them runs while other workers wait.

In turn of those that need other programs, so that no two workers compile the same ones at a time.
"""
COMPILED = pytest.StashKey[tempfile.TemporaryDirectory[str]]()


def pytest_configure(config: pytest.Config) -> None:
    """Let all workers of this run share compiled programs: they need the same ones.

    Most of the time of many tests is compiling.  A folder that the environment names is kept.  The
    name is that of the program's own folder (`sysid.cli.compile_cache`) under `XDG_CACHE_HOME`:
    JAX takes what was compiled under another name for another program.
    """
    # an entry that another worker is just writing is compiled here as well
    damaged = "ignore:Error (reading|writing) persistent compilation cache entry:UserWarning"
    config.addinivalue_line("filterwarnings", damaged)
    if hasattr(config, "workerinput"):
        return
    if hasattr(config.option, "loadscopereorder"):  # files in this order, not by number of tests
        config.option.loadscopereorder = False
    folder = config.stash[COMPILED] = tempfile.TemporaryDirectory(
        prefix="sysid-tests-", ignore_cleanup_errors=True
    )
    os.environ["XDG_CACHE_HOME"] = folder.name
    if "JAX_COMPILATION_CACHE_DIR" not in os.environ:
        os.environ |= {
            "JAX_COMPILATION_CACHE_DIR": str(Path(folder.name) / "sysid" / "jax"),
            "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
            "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1",
        }


def pytest_unconfigure(config: pytest.Config) -> None:
    """Take the folder away again."""
    if COMPILED in config.stash:
        config.stash[COMPILED].cleanup()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the long files first."""
    places = {REPOSITORY / name: k for k, name in enumerate(LONG)}
    items.sort(key=lambda item: places.get(item.path, len(LONG)))


@pytest.fixture(autouse=True, scope="module")
def few_compiled_programs() -> Iterator[None]:
    """Drop compiled programs between files once there are many."""
    yield
    if "jax" in sys.modules:
        from sysid.diagnosis.compiled import MOST, make_room

        make_room(MOST // 2)


@pytest.fixture
def utfsm_folder() -> Path:
    """The UTFSM measurements, where they lie beside the repository."""
    folder = REPOSITORY.parent / "shared" / "data" / "utfsm"
    if not folder.is_dir():
        pytest.skip("the UTFSM measurements are not here (see datasets/utfsm/README.md)")
    return folder


@pytest.fixture
def utfsm_manifest() -> Path:
    return REPOSITORY / "datasets" / "utfsm" / "campaign.toml"


def damper_test(
    amplitude: float = 10.0,
    frequency: float = 2.0,
    current: float = 0.5,
    *,
    cycles: int = 4,
    rate: float = 200.0,
) -> np.ndarray:
    """Time (s), displacement (mm) and force (N) of a simple damper in a sinusoidal test, [n, 3]."""
    t = np.arange(round(cycles / frequency * rate)) / rate
    omega = 2 * np.pi * frequency
    v = omega * amplitude * np.cos(omega * t)
    force = (50.0 + 800.0 * current) * np.tanh(v / 20.0) + 0.4 * v + 30.0
    return np.column_stack([t, amplitude * np.sin(omega * t), force])


@pytest.fixture
def make_campaign(tmp_path: Path) -> Callable[..., Path]:
    """Make a folder of synthetic tests, one CSV a condition (amplitude mm, frequency Hz, A)."""

    def make(
        conditions: Sequence[tuple[float, float, float]] = ((10.0, 2.0, 0.0), (10.0, 2.0, 0.5)),
        name: str = "campaign",
        manifest: str | None = None,
    ) -> Path:
        folder = tmp_path / name
        folder.mkdir()
        for amplitude, frequency, current in conditions:
            lines = ["time_s,displacement_mm,force_N"]
            for row in damper_test(amplitude, frequency, current):
                lines.append(",".join(repr(float(value)) for value in row))
            path = folder / f"{amplitude:g}mm_{frequency:g}Hz_{current:g}A.csv"
            path.write_text("\n".join(lines) + "\n")
        if manifest is not None:
            (folder / "campaign.toml").write_text(manifest)
        return folder

    return make
