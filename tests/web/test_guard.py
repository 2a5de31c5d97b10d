"""What the app lets in: its own pages and hosts, who knows the token, and no more bytes than it may keep."""

import asyncio

import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.web import guard
from strikewave.web.guard import Guard

HOST = "127.0.0.1:8471"


def asked(headers, kind="http", token="", query=b"", body=(b"",), host=""):
    """Return what a guarded app that answers 200 and how many bytes it got sends to a request."""
    sent, chunks = [], list(body)

    async def app(scope, receive, send):
        size = 0
        if scope["type"] == "http":
            while True:
                message = await receive()
                if message["type"] == "http.disconnect":
                    size = -1
                    break
                size += len(message.get("body", b""))
                if not message.get("more_body"):
                    break
            await send({"type": "http.response.start", "status": 200, "headers": [(b"x-size", str(size).encode())]})
            await send({"type": "http.response.body", "body": b""})
        else:
            await send({"type": "websocket.accept"})

    async def receive():
        return {"type": "http.request", "body": chunks.pop(0), "more_body": bool(chunks)}

    async def send(message):
        sent.append(message)

    listed = headers.items() if isinstance(headers, dict) else headers
    raw = [(name.encode(), value.encode("latin-1")) for name, value in listed]
    scope = {"type": kind, "headers": raw, "query_string": query, "path": "/"}
    asyncio.run(Guard(app, token, host)(scope, receive, send))
    return sent


def status(sent):
    return sent[0].get("status", sent[0]["type"])


@pytest.mark.parametrize(
    ("headers", "expected"),
    [
        ({"host": HOST}, 200),
        ({"host": "localhost:8471"}, 200),
        ({"host": "[::1]:8471"}, 200),
        ({"host": HOST, "origin": f"http://{HOST}"}, 200),
        ({"host": "rebound.example:8471"}, 421),  # DNS rebinding: the name leads here, the page is somebody else's
        ({"host": "localhost.evil.example"}, 421),
        ({}, 421),
        ({"host": "[::1"}, 421),
        ({"host": "["}, 421),
        ({"host": f"{HOST}@evil.example"}, 421),
        ({"host": "evil.example#@127.0.0.1:8471"}, 421),
        ({"host": "127.0.0.1:99999999"}, 421),
        ({"host": HOST, "origin": "http://["}, 403),
        ({"host": HOST, "origin": "http://127.0.0.1:99999999"}, 403),
        ({"host": HOST, "origin": f"http://{HOST}/"}, 403),  # no browser sends a path
        ({"host": HOST, "origin": ""}, 403),
        ([("host", HOST), ("host", "rebound.example")], 400),
        ([("host", HOST), ("origin", f"http://{HOST}"), ("Origin", "http://evil.example")], 400),
        ({"host": HOST, "origin": "http://evil.example"}, 403),
        ({"host": HOST, "origin": "http://127.0.0.1:9999"}, 403),  # another server of this machine
        ({"host": HOST, "origin": "null"}, 403),  # a sandboxed frame, a file
        ({"host": HOST, "sec-fetch-site": "cross-site", "sec-fetch-mode": "no-cors"}, 403),
        ({"host": HOST, "sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate"}, 200),  # a link in a mail
    ],
)
def test_only_its_own_hosts_and_origins_are_answered(headers, expected):
    sent = asked(headers)
    assert status(sent) == expected
    if expected != 200:
        assert sent[1]["body"].decode().strip()


def test_the_name_at_which_it_was_asked_to_listen_is_its_own():
    assert status(asked({"host": "lab.example:8471"}, host="Lab.example")) == 200
    assert status(asked({"host": "lab.example:8471"})) == 421
    assert status(asked({"host": ""}, host="")) == 421


def test_a_websocket_of_another_origin_is_closed_before_it_opens():
    assert asked({"host": HOST, "origin": "http://evil.example"}, "websocket")[0]["type"] == "websocket.close"
    assert asked({"host": "rebound.example"}, "websocket")[0]["type"] == "websocket.close"
    assert asked({"host": HOST, "origin": "http://["}, "websocket")[0]["type"] == "websocket.close"
    assert asked({"host": HOST, "origin": f"http://{HOST}"}, "websocket")[0]["type"] == "websocket.accept"


def test_the_token_of_the_address_becomes_a_cookie_that_no_other_site_sends():
    assert status(asked({"host": HOST}, token="secret")) == 401
    assert status(asked({"host": HOST}, token="secret", query=b"token=wrong")) == 401
    assert status(asked({"host": HOST, "cookie": "strikewave-token=wrong"}, token="secret")) == 401
    sent = asked({"host": HOST}, token="secret", query=b"token=secret")
    cookie = dict(sent[0]["headers"])[b"set-cookie"].decode()
    assert status(sent) == 200
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie
    kept = cookie.partition(";")[0]
    assert status(asked({"host": HOST, "cookie": kept}, token="secret")) == 200
    for other in ('a={"b": 1, "c": [2]}', "a[0]=1", "=", "a=\xe9"):  # programs of other ports set these
        assert status(asked({"host": HOST, "cookie": f"{other}; {kept}"}, token="secret")) == 200
        assert status(asked([("host", HOST), ("cookie", other), ("cookie", kept)], token="secret")) == 200


HEADER = st.tuples(
    st.sampled_from(["host", "origin", "cookie", "content-length", "sec-fetch-site"]), st.text(max_size=9)
)


@given(st.lists(HEADER), st.binary(max_size=20), st.sampled_from(["http", "websocket"]))
def test_whatever_a_request_says_is_answered_in_words_or_let_in(headers, query, kind):
    said = [(name, text.encode("utf-8", "replace").decode("latin-1")) for name, text in headers]
    sent = asked([("host", HOST), *said], kind, token="secret", query=query)
    assert status(sent) in (400, 401, 403, 413, 421, "websocket.close")


def test_too_much_is_refused_by_its_length_and_where_that_lies(monkeypatch):
    assert status(asked({"host": HOST, "content-length": str(5 << 30)})) == 413
    for nonsense in ("-1", "\xb2", "", "1e3", "9" * 5000):
        assert status(asked({"host": HOST, "content-length": nonsense})) == 413
    monkeypatch.setattr(guard, "LARGEST_UPLOAD", 1000)
    sent = asked({"host": HOST, "content-length": "10"}, body=[b"x" * 600, b"x" * 600, b""])
    assert dict(sent[0]["headers"])[b"x-size"] == b"-1"  # the app saw the client go, not the bytes


def test_answers_forbid_browsers_to_fetch_elsewhere_and_others_to_frame_them():
    headers = dict(asked({"host": HOST})[0]["headers"])
    policy = headers[b"content-security-policy"].decode()
    assert "default-src 'self'" in policy
    assert "frame-ancestors 'self'" in policy
    assert headers[b"x-content-type-options"] == b"nosniff"
