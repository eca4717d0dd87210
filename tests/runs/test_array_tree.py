"""Weights come back bit by bit, or not at all."""

from pathlib import Path
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from safetensors.numpy import save

from neuralgaits.errors import RunError
from neuralgaits.runs import read_arrays, read_tree, write_arrays, write_tree
from neuralgaits.runs.arrays import packed


class Net(eqx.Module):
    weight: jax.Array
    constant: np.ndarray
    name: str = eqx.field(static=True)


def _state(scale: float = 1.0) -> dict[str, Any]:
    net = Net(scale * jnp.arange(6.0).reshape(2, 3), np.asarray(0.1 * scale), "net")
    key = jax.random.key(int(scale))
    return {"net": net, "key": key, "step": int(7 * scale), "best": 0.3 * scale, "f": jnp.tanh}


def test_every_kind_of_leaf_comes_back(tmp_path: Path) -> None:
    path = tmp_path / "state.safetensors"
    write_tree(path, _state(3.0))
    back = read_tree(path, _state(1.0))
    assert np.array_equal(back["net"].weight, _state(3.0)["net"].weight)
    assert isinstance(back["net"].weight, jax.Array)
    assert isinstance(back["net"].constant, np.ndarray)
    assert back["net"].constant == _state(3.0)["net"].constant
    assert (back["step"], back["best"]) == (21, _state(3.0)["best"])
    assert type(back["step"]) is int
    assert back["f"] is jnp.tanh
    assert jax.random.uniform(back["key"]) == jax.random.uniform(jax.random.key(3))


def test_reads_into_shapes_alone(tmp_path: Path) -> None:
    path = tmp_path / "a.safetensors"
    write_tree(path, {"a": jnp.arange(3)})
    back = read_tree(path, jax.eval_shape(lambda: {"a": jnp.arange(3)}))
    assert back["a"].tolist() == [0, 1, 2]


@given(
    hnp.arrays(
        st.sampled_from([np.float64, np.float32, np.uint32, np.bool_]),
        hnp.array_shapes(min_dims=0, min_side=0),
    )
)
def test_arrays_keep_every_bit(tmp_path_factory: pytest.TempPathFactory, array: Any) -> None:
    path = tmp_path_factory.mktemp("tree") / "a.safetensors"
    write_tree(path, [array.T])
    (back,) = read_tree(path, [np.zeros_like(array.T)])
    assert back.shape == array.T.shape
    assert back.dtype == array.dtype
    assert back.tobytes() == array.T.tobytes()


@pytest.mark.parametrize(
    ("like", "message"),
    [
        (
            {"a": np.zeros((3, 2))},
            r"array \['a'\]: expected float64\[3, 2\], found float64\[2, 3\]",
        ),
        ({"a": np.zeros((2, 3), np.float32)}, r"expected float32\[2, 3\], found float64\[2, 3\]"),
        ({"b": np.zeros((2, 3))}, r"array \['a'\]: the model has none"),
        ({"a": np.zeros((2, 3)), "b": np.zeros(1)}, r"array \['b'\]: it is missing"),
        ({"a": 1.0}, r"expected a float, found float64\[2, 3\]"),
    ],
)
def test_refuses_what_does_not_fit(tmp_path: Path, like: Any, message: str) -> None:
    path = tmp_path / "a.safetensors"
    write_tree(path, {"a": np.ones((2, 3))})
    with pytest.raises(RunError, match=message) as caught:
        read_tree(path, like)
    assert "\n" not in str(caught.value)


def test_refuses_a_damaged_file(tmp_path: Path) -> None:
    path = tmp_path / "a.safetensors"
    with pytest.raises(RunError, match="found none"):
        read_tree(path, [np.ones(3)])
    write_tree(path, [np.ones(3)])
    path.write_bytes(path.read_bytes()[:-4])
    with pytest.raises(RunError, match="damaged file"):
        read_tree(path, [np.ones(3)])
    path.write_bytes(b"\x80\x04K\x01.")
    with pytest.raises(RunError, match="damaged file"):
        read_tree(path, [np.ones(3)])


def test_a_bit_that_flipped_is_no_other_number(tmp_path: Path) -> None:
    path = tmp_path / "a.safetensors"
    for write in (
        lambda: write_tree(path, {"a": np.arange(4.0)}),
        lambda: write_arrays(path, {"a": np.arange(4.0)}, {"of": "b"}),
    ):
        write()
        whole = path.read_bytes()
        (array,) = read_arrays(path)[0].values()
        assert array.tolist() == [0.0, 1.0, 2.0, 3.0]
        for flipped in (bytes([whole[-1] ^ 1]), bytes([whole[-1] ^ 0x80])):
            path.write_bytes(whole[:-1] + flipped)
            with pytest.raises(RunError, match="its sha256 is another"):
                read_arrays(path)
        path.write_bytes(whole.replace(b'"a":{', b'"b":{').replace(b"['a']", b"['b']"))
        with pytest.raises(RunError, match="its sha256 is another"):
            read_arrays(path)


def test_files_of_other_programs_have_no_sha256(tmp_path: Path) -> None:
    path = tmp_path / "a.safetensors"
    path.write_bytes(save({"a": np.ones(2)}, metadata={"of": "b"}))
    arrays, metadata = read_arrays(path)
    assert arrays["a"].tolist() == [1.0, 1.0] and metadata == {"of": "b"}


def test_the_same_arrays_give_the_same_bytes() -> None:
    arrays = {name: np.arange(3.0) for name in "abcdef"}
    metadata = {name: name for name in "uvwxyz"}
    turned = dict(reversed(arrays.items())), dict(reversed(metadata.items()))
    assert len({packed(arrays, metadata) for _ in range(10)} | {packed(*turned)}) == 1
