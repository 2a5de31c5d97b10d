"""How the app begins: what it needs, where it listens, what is refused before anything is served."""

import http.client
import http.cookiejar
import re
import socket
import sys
import urllib.request
from urllib.parse import urljoin, urlsplit

import pytest

from strikewave.web.server import is_loopback

from .conftest import serving


def test_without_nicegui_it_says_what_to_install(strikewave, monkeypatch):
    monkeypatch.setitem(sys.modules, "nicegui", None)
    code, _, err = strikewave("app", "--no-browser")
    assert code == 2
    assert "strikewave app needs NiceGUI: pip install 'strikewave[app]'" in err


def test_a_port_that_is_taken_and_a_host_of_another_machine_are_refused_in_one_line(strikewave):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        code, _, err = strikewave("app", "--no-browser", "--port", str(taken.getsockname()[1]))
    assert code == 2
    assert "--port" in err
    assert len(err.splitlines()) == 1
    code, _, err = strikewave("app", "--no-browser", "--host", "192.0.2.1")  # of nobody, by RFC 5737
    assert code == 2
    assert "192.0.2.1" in err
    for nonsense in ("..", "a" * 70, ""):
        code, _, err = strikewave("app", "--no-browser", "--host", nonsense)
        assert (code, len(err.splitlines())) == (2, 1)
        assert "--host" in err


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


ASKED_FOR = re.compile(r'"(/[^"]*\.(?:js|css|mjs)[^"]*)"')
"""Places of scripts and styles in a page, those of its map of imports too."""
UPGRADE = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
}
SOCKET = "/_nicegui_ws/socket.io/?EIO=4&transport=websocket"


@pytest.fixture(scope="module")
def shared_address(tmp_path_factory):
    """Return the address that an app prints which other machines can reach."""
    with serving(tmp_path_factory.mktemp("app"), "--host", "0.0.0.0") as address:
        yield address


def answered(address, place, headers):
    """Return the status of an answer."""
    line = http.client.HTTPConnection(urlsplit(address).netloc, timeout=30)
    try:
        line.request("GET", place, headers=headers)
        return line.getresponse().status
    finally:
        line.close()


def test_a_fresh_browser_gets_all_that_the_page_of_the_printed_address_asks_for(shared_address):
    """The page sets a cookie of its session and one of the token: each request after it has to bring both."""
    jar = http.cookiejar.CookieJar()
    browser = urllib.request.build_opener(urllib.request.HTTPCookieProcessor(jar))
    page = browser.open(shared_address, timeout=30).read().decode()
    port = urlsplit(shared_address).port
    assert {cookie.name for cookie in jar} == {f"strikewave-session-{port}", f"strikewave-token-{port}"}
    places = sorted(set(ASKED_FOR.findall(page)))
    assert len(places) > 10
    assert {browser.open(urljoin(shared_address, place), timeout=30).status for place in places} == {200}
    cookies = {"Cookie": "; ".join(f"{cookie.name}={cookie.value}" for cookie in jar)}
    assert answered(shared_address, SOCKET, UPGRADE | cookies) == 101
    assert {answered(shared_address, place, {}) for place in places} == {401}
    assert answered(shared_address, SOCKET, UPGRADE) == 403


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Origin": "http://["}, 403),
        ({"Host": "["}, 421),
        ({"Host": "127.0.0.1:99999999"}, 421),
        ({"X-Forwarded-For": "[::", "X-Forwarded-Proto": "javascript", "X-Forwarded-Host": "["}, 200),
        ({"Cookie": 'a={"b": [1]}; =; \xff'}, 200),
    ],
)
def test_no_header_that_a_visitor_sends_is_an_error_of_the_server(shared_address, headers, status):
    query = f"/record?{urlsplit(shared_address).query}"
    assert answered(shared_address, query, headers) == status
    assert answered(shared_address, SOCKET + f"&{urlsplit(shared_address).query}", UPGRADE | headers) in (101, 403)
