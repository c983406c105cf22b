"""The site of ``docs/``: it builds without a broken link, and shows all that there is."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest
from PIL import Image

from fuzzyq_bullet import Result
from fuzzyq_bullet.scenario import bundled_scenarios, load_scenario
from tests.helpers.pages import DOCS, PAGES, ROOT
from tests.test_unchanged import KNOWN, SAME_SINES, known


def tool(name: str) -> ModuleType:
    """Return one of the tools in ``docs/tools``."""
    spec = importlib.util.spec_from_file_location(name, DOCS / "tools" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


links = tool("code_links")
figures = tool("figures")
gallery = tool("gallery")


@pytest.mark.parametrize("page", links.PAGES, ids=lambda page: page.name)
def test_a_name_of_code_leads_to_the_lines_where_it_is(page: Path) -> None:
    assert page.read_text(encoding="utf-8") == links.renewed(page), "make format puts them right"


def test_a_name_that_is_not_there_is_a_mistake(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("See `planning.escape.Escapade`.")
    with pytest.raises(ValueError, match=r"page.md: there is no planning.escape.Escapade"):
        links.renewed(page)


def test_a_link_to_code_has_the_lines_of_today(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("See [`planning.escape.escape.Escape.aim`](../../old.py#L1-L2).")
    path, _, lines = links.renewed(page).partition("(")[2].rstrip(").").partition("#")
    first, last = (int(number) for number in re.findall(r"\d+", lines))
    told = (tmp_path / path).read_text(encoding="utf-8").splitlines()[first - 1 : last]
    assert told[0].startswith("    def aim(")
    assert told[-1].startswith("        return")


def test_the_table_of_figures_is_what_the_result_says_of_itself() -> None:
    page = figures.PAGE.read_text(encoding="utf-8")
    assert page == figures.renewed(), "make format puts it right"
    for name in Result.model_fields:
        assert f"\n| `{name}` | " in page


def test_the_gallery_has_every_bundled_scenario_as_it_is_today() -> None:
    told = gallery.known()
    assert sorted(told) == sorted(bundled_scenarios()), "make gallery"
    assert gallery.PAGE.read_text(encoding="utf-8") == gallery.page(told), "make gallery"
    pictures = sorted(path.stem for path in gallery.PICTURES.iterdir())
    assert pictures == sorted(told), "make gallery"


@pytest.mark.parametrize("name", sorted(bundled_scenarios()))
def test_its_picture_is_one_to_look_at(name: str) -> None:
    file = gallery.picture(name)
    assert file.stat().st_size < 40_000
    with Image.open(file) as picture:
        assert max(picture.size) == gallery.WIDEST
        assert len(picture.convert("RGB").getcolors(1 << 20) or []) > 50


@pytest.mark.skipif(not SAME_SINES, reason="digests are those of Linux on x86-64")
def test_the_pictures_show_the_runs_of_today() -> None:
    kept = KNOWN.read_text(encoding="utf-8")
    ends = {name: digest for name, (_, digest) in gallery.known().items() if f'"{name}"' in kept}
    now = {name: known(name).split()[1] for name in ends}
    assert ends == now, "make gallery"


def test_every_page_is_in_the_navigation() -> None:
    told = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    named = set(re.findall(r"([\w/-]+\.md)$", told, re.MULTILINE))
    pages = {page.relative_to(DOCS).as_posix() for page in DOCS.rglob("*.md")}
    assert named == pages


def test_a_page_shows_no_machine_of_ours() -> None:
    for page in PAGES:
        assert not re.search(r"/(?:home|root|work|tmp)/\w", page.read_text("utf-8")), page.name


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", folder]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.mark.slow
def test_it_has_the_command_line_as_it_helps_itself(site: Path) -> None:
    page = (site / "reference" / "cli.html").read_text(encoding="utf-8")
    for told in ("fuzzyq run", "fuzzyq bench learning", "--planner", "--no-video", "Seed to use"):
        assert told in page


@pytest.mark.slow
def test_it_has_the_public_names_of_the_package(site: Path) -> None:
    import fuzzyq_bullet

    page = (site / "reference" / "python.html").read_text(encoding="utf-8")
    for name in fuzzyq_bullet.__all__:
        if not name.startswith("_"):
            assert f'id="fuzzyq_bullet.{name}"' in page, name


@pytest.mark.slow
def test_code_is_there_to_the_line(site: Path) -> None:
    page = (site / "explanation" / "paper.html").read_text(encoding="utf-8")
    path, line = re.findall(r'href="(\.\./source/[^"#]+escape\.py\.html)#(L-\d+)"', page)[0]
    assert f'id="{line}"' in (site / "explanation" / path).read_text(encoding="utf-8")


@pytest.mark.slow
def test_nothing_is_fetched_from_elsewhere(site: Path) -> None:
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        fetched = re.findall(r'<(?:script|img|iframe)[^>]+src="(https?:[^"]+)"', text)
        fetched += re.findall(
            r'<link[^>]+rel="(?:stylesheet|preconnect)"[^>]+href="(http[^"]+)"', text
        )
        assert fetched == [], page.name


def test_a_description_is_what_the_scenario_says() -> None:
    told = gallery.PAGE.read_text(encoding="utf-8")
    assert load_scenario("mixed").description in told
