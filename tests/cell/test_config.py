import pytest
from hypothesis import given
from hypothesis import strategies as st

from cell.config import DEMO_CELL, CellConfig, load_cell, with_shots
from hal.errors import ConfigError

TEXT = DEMO_CELL.read_text()


def refused(tmp_path, old, new):
    assert old in TEXT
    path = tmp_path / "cell.toml"
    path.write_text(TEXT.replace(old, new, 1))
    with pytest.raises(ConfigError) as caught:
        load_cell(path)
    message = str(caught.value)
    assert "\n" not in message
    assert str(path) in message
    return message


def test_the_demo_cell_is_a_cell():
    config = load_cell()
    assert config.layout.bin.size_m == (0.36, 0.26, 0.14)
    assert config.layout.tray.T_base_tray.translation_m.tolist() == [0.30, -0.50, 0.05]


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("[motion]", "[motion]\nspeed = 1.0", "motion.speed: is not a key"),
        ("force_n = 90.0", "force_n = 120.0", "grasp.force_n: Input should be less than or equal"),
        ("force_n = 90.0", "force_n = nan", "grasp.force_n"),
        ("shots = 4", "shots = 0", "camera.shots"),
        ("shots = 4", 'shots = "many"', "camera.shots"),
        ('backend = "abb-rapid"', "", "robot.backend: is missing"),
        ("size_m = [0.36, 0.26, 0.14]", "size_m = [0.36, 0.26]", "bin.size_m"),
        (
            "position_m = [0.30, -0.50, 0.05]",
            "position_m = [0.50, 0.0, 0.05]",
            "bin and tray overlap",
        ),
        ("[grasp]", "[grasp", "is not TOML"),
    ],
)
def test_what_cannot_be_is_refused_with_the_file_and_the_key(tmp_path, old, new, says):
    assert says in refused(tmp_path, old, new)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(ConfigError, match=r"none\.toml: cannot be read: No such file"):
        load_cell(tmp_path / "none.toml")


@given(st.binary(max_size=300))
def test_any_bytes_are_a_cell_or_one_line(tmp_path_factory, data):
    path = tmp_path_factory.mktemp("cells") / "cell.toml"
    path.write_bytes(data)
    with pytest.raises(ConfigError) as caught:
        load_cell(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("shots", [0, 17])
def test_shots_have_a_range(shots):
    with pytest.raises(ConfigError, match=r"outside 1\.\.16"):
        with_shots(load_cell(), shots)


def keys(model, prefix=""):
    for name, field in model.model_fields.items():
        inner = field.annotation
        if isinstance(inner, type) and issubclass(inner, type(load_cell()).__mro__[1]):
            yield from keys(inner, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}"


def test_the_reference_page_names_every_key():
    page = (DEMO_CELL.parents[2] / "docs/reference/cell-file.md").read_text()
    devices = ("robot.", "gripper.", "camera.", "projector.")
    missing = []
    for key in keys(CellConfig):
        shown = key.split(".")[-1] if key.startswith(devices) else key
        if f"`{shown}`" not in page:
            missing.append(key)
    assert not missing
