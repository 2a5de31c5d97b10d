"""A server of the app under hostile requests: each is refused in words, and the next visitor is served."""

import http.client
import os
from urllib.parse import urlsplit

import pytest

from strikewave.web.sessions import MOST_SESSIONS

pytestmark = pytest.mark.verify

UPGRADE = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
}


def asked(address, headers, method="GET", path="/record"):
    """Return the status and the text that the server answers."""
    line = http.client.HTTPConnection(urlsplit(address).netloc, timeout=30)
    try:
        line.request(method, path, headers=headers)
        answer = line.getresponse()
        return answer.status, answer.read().decode()
    finally:
        line.close()


@pytest.mark.parametrize(
    ("method", "path", "headers", "status", "words"),
    [
        ("POST", "/record", {"Content-Length": str(5 << 30)}, 413, "256 MB at a time"),
        ("POST", "/record", {"Origin": "http://evil.example", "Content-Length": "0"}, 403, "another origin"),
        ("GET", "/record", {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "no-cors"}, 403, "another origin"),
        ("GET", "/record", {"Host": "rebound.example"}, 421, "its own address"),
        (
            "GET",
            "/_nicegui_ws/socket.io/?EIO=4&transport=websocket",
            UPGRADE | {"Origin": "http://evil.example"},
            403,
            "",
        ),
        ("GET", "/kept/..%2F..%2F..%2F..%2Fetc%2Fpasswd", {}, 404, ""),
        ("GET", "/kept/passwd", {}, 404, "no such page"),
    ],
)
def test_it_is_refused_in_words_and_the_next_visitor_is_served(app_address, method, path, headers, status, words):
    found, text = asked(app_address, headers, method, path)
    assert found == status
    assert words in text
    assert "root:" not in text
    assert asked(app_address, {})[0] == 200


def test_an_upload_that_is_cut_in_the_middle_leaves_the_server_alive(app_address):
    line = http.client.HTTPConnection(urlsplit(app_address).netloc, timeout=30)
    line.putrequest("POST", "/record")
    line.putheader("Content-Length", str(100 << 20))
    line.endheaders()
    line.send(os.urandom(1 << 16))
    line.close()
    assert asked(app_address, {})[0] == 200


def test_more_browsers_than_it_takes_are_told_so_and_the_others_stay(crowded_address):
    """Each request without a cookie is a browser of its own; all open a page at once, and none leaves."""
    answers = [asked(crowded_address, {}) for _ in range(MOST_SESSIONS + 2)]
    assert {status for status, _ in answers} == {200}
    told = [f"{MOST_SESSIONS} browsers use this app now" in text for _, text in answers]
    assert told == [False] * MOST_SESSIONS + [True] * 2
