"""Whether kernels have to be compiled, by the files of the cache."""

from strikewave.base import compiled


def test_cold_without_a_kernel_of_that_name(tmp_path, monkeypatch):
    monkeypatch.setattr(compiled, "cache_folder", lambda: str(tmp_path))
    assert compiled.is_cold()
    assert compiled.is_cold("run_train")
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "_kernels.advance-12.py311.nbi").write_bytes(b"")
    assert not compiled.is_cold()
    assert not compiled.is_cold("advance")
    assert compiled.is_cold("run_train")
