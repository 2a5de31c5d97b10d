"""How the app begins: what it needs, where it listens, what is refused before anything is served."""

import socket
import sys

import pytest

from strikewave.web.server import is_loopback


def test_without_nicegui_it_says_what_to_install(strikewave, monkeypatch):
    monkeypatch.setitem(sys.modules, "nicegui", None)
    code, _, err = strikewave("app", "--no-browser")
    assert code == 2
    assert 'pip install "strikewave[app]"' in err


def test_a_port_that_is_taken_and_a_host_of_another_machine_are_refused_in_one_line(strikewave):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        code, _, err = strikewave("app", "--no-browser", "--port", str(taken.getsockname()[1]))
    assert code == 2
    assert "--port" in err
    assert len(err.splitlines()) == 1
    code, _, err = strikewave("app", "--no-browser", "--host", "192.0.2.1")  # of nobody, by RFC 5737
    assert code == 2
    assert "192.0.2.1" in err


def test_a_file_is_no_folder_for_results(strikewave, tmp_path):
    (tmp_path / "file").write_text("")
    code, _, err = strikewave("app", "--folder", str(tmp_path / "file"))
    assert code == 2
    assert "this is a file" in err


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.4", "localhost.evil.example", "10.0.0.1"])
def test_only_loopback_needs_no_token(host):
    assert not is_loopback(host)
    assert is_loopback("127.0.0.1")
    assert is_loopback("::1")
