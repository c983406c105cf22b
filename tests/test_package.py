"""The package: what Python users import, and what an installation away from the checkout holds."""

from __future__ import annotations

import json
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from pathlib import Path
from typing import Literal

import pytest

import fuzzyq_bullet
from fuzzyq_bullet import (
    Decision,
    Observation,
    Planner,
    PlannerSettings,
    Trajectory,
    UserError,
    load_scenario,
    register_planner,
    result_of,
    run,
    with_options,
)

ROOT = Path(__file__).resolve().parent.parent


# --- what is imported


def test_every_public_name_is_there_and_no_other() -> None:
    for name in fuzzyq_bullet.__all__:
        assert getattr(fuzzyq_bullet, name) is not None
        assert name in dir(fuzzyq_bullet)
    with pytest.raises(AttributeError, match="'fuzzyq_bullet' has no attribute 'Robot'"):
        _ = fuzzyq_bullet.Robot


def test_importing_the_package_loads_nothing_that_takes_time() -> None:
    code = (
        "import sys, fuzzyq_bullet\n"
        "print([n for n in ('numpy', 'pydantic', 'pybullet') if n in sys.modules])\n"
        "fuzzyq_bullet.Planner, fuzzyq_bullet.load_scenario, fuzzyq_bullet.Trajectory\n"
        "print([n for n in ('pybullet', 'matplotlib') if n in sys.modules])\n"
        "import fuzzyq_bullet.video, fuzzyq_bullet.scenario\n"
        "print(callable(fuzzyq_bullet.run))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["[]", "[]", "True"]


class StraightSettings(PlannerSettings):
    """One parameter, to see that it arrives."""

    name: Literal["straight"] = "straight"
    step: float = 0.2


class Straight:
    """Goes straight on, whatever is in its way."""

    def __init__(self, settings: StraightSettings) -> None:
        self._step = settings.step

    def decide(self, observation: Observation, /) -> Decision:
        return Decision(heading=0.0, step=self._step)


@pytest.fixture(scope="module")
def straight() -> str:
    """A planner of a user's own, and its name."""
    planner: Planner = Straight(StraightSettings())  # the type checker's word for it
    del planner
    register_planner("straight", StraightSettings, lambda settings, rng: Straight(settings))
    return "straight"


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_a_planner_of_ones_own_runs_into_what_it_does_not_look_at(
    straight: str, drive: str, tmp_path: Path
) -> None:
    path = tmp_path / "wall.yaml"
    path.write_text(
        "name: wall\narena: {size: [4.0, 2.0]}\n"
        "start: {position: [0.6, 1.0]}\ngoal: {position: [3.4, 1.0]}\n"
        "planner: {name: straight, step: 0.1}\n"
        "obstacles: [{shape: box, position: [1.5, 1.0], size: [0.2, 1.0]}]\n"
    )
    trajectory = run(with_options(load_scenario(path), drive=drive))
    result = result_of(trajectory)
    assert (result.planner, result.outcome, result.collisions) == (straight, "collision", 1)
    assert trajectory.collision is not None
    assert trajectory.collision.obstacle == 0
    assert 1.19 < trajectory.collision.point[0] < 1.41  # between the robot's centre and the wall
    assert set(trajectory.decisions.step) == {0.1}
    # What it left blank stays blank on disk and back.
    trajectory.save(tmp_path / "wall.npz")
    again = Trajectory.load(tmp_path / "wall.npz")
    assert again.digest() == trajectory.digest()
    assert again.scenario == trajectory.scenario


def test_a_name_is_given_once(straight: str) -> None:
    with pytest.raises(ValueError, match="registered already"):
        register_planner(straight, StraightSettings, lambda settings, rng: Straight(settings))


# --- what is installed


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the source archive of the checkout, and the wheel made from that archive."""
    folder = tmp_path_factory.mktemp("dist")
    command = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(folder), str(ROOT)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture(scope="module")
def elsewhere(built: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment with the wheel in it, which borrows its dependencies from this one."""
    folder = tmp_path_factory.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
    (wheel,) = built.glob("*.whl")
    pip = [sys.executable, "-m", "pip", "--python", str(folder / "bin" / "python")]
    install = [*pip, "install", "--quiet", "--no-deps", "--no-index", str(wheel)]
    done = subprocess.run(install, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    # Found behind the environment's own packages, and .pth files in it do not count: the checkout,
    # to which one of them leads, is not seen.
    (site,) = folder.glob("lib/python*/site-packages")
    (site / "borrowed.pth").write_text(sysconfig.get_paths()["purelib"] + "\n")
    return folder


@pytest.mark.slow
def test_the_wheel_holds_the_data_and_nothing_of_the_checkout_besides(built: Path) -> None:
    (wheel,) = built.glob("*.whl")
    names = set(zipfile.ZipFile(wheel).namelist())
    assert {name.split("/")[0] for name in names} == {
        "fuzzyq_bullet",
        f"fuzzyq_bullet-{fuzzyq_bullet.__version__}.dist-info",
    }
    for folder in ("assets", "scenarios"):
        for path in (ROOT / folder).rglob("*.*"):
            assert f"fuzzyq_bullet/_data/{path.relative_to(ROOT).as_posix()}" in names
    for path in (ROOT / "fuzzyq_bullet" / "page").rglob("*.*"):
        if path.suffix != ".pyc":
            assert path.relative_to(ROOT).as_posix() in names
    assert "fuzzyq_bullet/py.typed" in names
    (source,) = built.glob("*.tar.gz")
    with tarfile.open(source) as archive:
        inside = {"/".join(Path(name).parts[1:]) for name in archive.getnames()}
    assert {"README.md", "LICENSE", "scenarios/mixed.yaml", "tests/test_package.py"} <= inside
    assert not any(name.startswith((".venv", "out", ".git/")) for name in inside)


@pytest.mark.slow
def test_an_installed_package_runs_away_from_the_checkout(elsewhere: Path, tmp_path: Path) -> None:
    def call(*args: str) -> str:
        command = [str(elsewhere / "bin" / args[0]), *args[1:]]
        done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        return done.stdout

    code = (
        "from fuzzyq_bullet import platforms\n"
        "print(platforms.__file__)\n"
        "print(platforms.data_folder('assets'), platforms.data_folder('scenarios'))"
    )
    for place in call("python", "-c", code).split():
        assert Path(place).is_relative_to(elsewhere)
    assert set(json.loads(call("fuzzyq", "list", "--json"))) >= {"boxes", "mixed"}
    result = json.loads(call("fuzzyq", "run", "open-field", "--no-video", "--json"))
    assert result["outcome"] == "goal"
    assert (tmp_path / "out" / "open-field.npz").exists()


@pytest.mark.parametrize(
    "imports",
    [
        "import fuzzyq_bullet, gymnasium",
        "import gymnasium, fuzzyq_bullet",
        "import fuzzyq_bullet.gym",
    ],
)
def test_the_environments_are_known_to_gymnasium_and_no_physics_is_loaded(imports: str) -> None:
    code = (
        f"import sys\n{imports}\nimport gymnasium\n"
        "ids = [name for name in gymnasium.registry if name.startswith('fuzzyq_bullet/')]\n"
        "print(len(ids), gymnasium.spec(ids[0]).id == ids[0], 'pybullet' in sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "2 True False\n"


def test_a_trajectory_is_one_short_line_and_equal_to_its_like() -> None:
    short = with_options(load_scenario("boxes"), drive="kinematic")
    one, same, other = run(short), run(short), run(with_options(short, planner="fuzzy"))
    assert one == same
    assert hash(one) == hash(same)
    assert one != other
    assert one != "boxes"
    text = repr(one)
    assert text.startswith("<Trajectory boxes: goal after ")
    assert "\n" not in text
    assert len(text) < 100


def test_what_python_users_may_do_wrong_is_one_clear_error(tmp_path: Path) -> None:
    from fuzzyq_bullet.episode import Episode, run_in
    from fuzzyq_bullet.learning import load_policy
    from fuzzyq_bullet.physics.sensor_world import SensorWorld
    from fuzzyq_bullet.planning import ImprovedFuzzyPlanner, ImprovedFuzzySettings
    from fuzzyq_bullet.scenario import dump_scenario, parse_scenario

    boxes = with_options(load_scenario("boxes"), drive="kinematic")
    mixed = with_options(load_scenario("mixed"), drive="kinematic")
    with SensorWorld(boxes.obstacles, boxes.arena) as world:
        with pytest.raises(ValueError, match="the world was not built for the scenario mixed"):
            run_in(world, mixed, ImprovedFuzzyPlanner(ImprovedFuzzySettings()))
        episode = Episode(world, boxes)
        while episode.outcome is None:
            episode.advance(Decision(heading=0.0, step=0.0, hopeless=True))
        with pytest.raises(ValueError, match=r"the episode is over \(stuck\); begin another"):
            episode.advance(Decision(heading=0.0, step=0.0))
    unknown = boxes.model_copy(update={"planner": PlannerSettings(name="elsewhere")})
    with pytest.raises(UserError, match=r"no planner 'elsewhere'; .* --plugin FILE"):
        run(unknown)
    policy = load_policy(str(ROOT / "assets" / "policies" / "q-lambda.json"))
    policy.save(str(tmp_path / "mine.json"))
    assert load_policy(str(tmp_path / "mine.json")) == policy

    class Odd(PlannerSettings):
        name: Literal["odd"] = "odd"
        table: dict[str, float] = {}  # noqa: RUF012 (pydantic copies it)

    register_planner("odd", Odd, lambda settings, rng: None)  # type: ignore[arg-type,return-value]
    odd = boxes.model_copy(update={"planner": Odd(table={"a, b": 1.0, "c: {": 2.0, "yes": 3.0})})
    assert parse_scenario(dump_scenario(odd)) == odd


@pytest.mark.slow
@pytest.mark.parametrize(("ending", "magic"), [(".gif", b"GIF89a"), (".webp", b"RIFF")])
def test_an_animated_picture_is_what_its_name_says(
    ending: str, magic: bytes, filmed: Path, tmp_path: Path
) -> None:
    from PIL import Image

    from fuzzyq_bullet.video import record

    path = tmp_path / f"short{ending}"
    info = record(Trajectory.load(filmed / "short.npz"), str(path), speed=4)
    assert path.read_bytes().startswith(magic)
    with Image.open(path) as image:
        assert image.size == info.size == (640, 360)
        assert 1 < getattr(image, "n_frames", 1) <= info.frames
    with pytest.raises(UserError, match=r"short\.avi: a film ends in \.mp4"):
        record(Trajectory.load(filmed / "short.npz"), tmp_path / "short.avi")
