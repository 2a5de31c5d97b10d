"""Access to the app: this machine, or a browser with the token; no other page that a browser happens to show.

A page of another origin can make a browser send requests here, and by DNS rebinding even read the answers. So every
request and every websocket must name this server as its host, and none may come from another origin. The size of a
request is known before it is stored.
"""

from __future__ import annotations

import hmac
import ipaddress
import re
import socket
from collections.abc import Awaitable, Callable, Iterable, MutableMapping
from typing import Any
from urllib.parse import parse_qs

from starlette.requests import cookie_parser

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

LARGEST_UPLOAD = 256 << 20
"""Most bytes of one request: a record of 30 million samples in single precision, or 20 of a million as text."""
COOKIE = "strikewave-token"
"""Start of the name of the cookie with the token; the port follows, since a host's cookies go to all its ports and a
second app would replace that of the first."""
HOST = re.compile(r"(?P<name>\[[0-9a-f:.]+\]|[^\[\]:/?#@\\\s]+)(:[0-9]{1,5})?", re.IGNORECASE)
"""Name or number of a host and its port, as a request names them."""
ONCE = ("host", "origin", "content-length")
"""Headers that a request has once: of two, the guard might judge one and the pages heed the other."""
LONGEST_LENGTH = 19
"""Digits of the length of a request: as many as a 64-bit machine counts; Python refuses to read thousands."""
POLICY = "; ".join(
    (
        "default-src 'self'",
        "script-src 'self' 'unsafe-inline' 'unsafe-eval'",  # the kit of the pages is written so
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' data: blob:",
        "font-src 'self' data:",
        "connect-src 'self' ws: wss:",
        "frame-src 'self' blob: data:",
        "object-src 'none'",
        "base-uri 'none'",
        "form-action 'self'",
        "frame-ancestors 'self'",
    )
)
HEADERS = (
    (b"content-security-policy", POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-resource-policy", b"same-origin"),
)


def is_own_host(host: str, names: frozenset[str]) -> bool:
    """Tell whether the host that a request names is this machine: by number, or by one of its names.

    A name of somebody else that was made to lead here is not; a number cannot be made to.

    Examples
    --------
    >>> names = frozenset({"localhost"})
    >>> [is_own_host(host, names) for host in ("127.0.0.1:8080", "[::1]:8080", "localhost", "evil.example:8080", "[")]
    [True, True, True, False, False]
    """
    parts = HOST.fullmatch(host)
    if parts is None:
        return False
    name = parts["name"].lower().strip("[]")
    if name in names:
        return True
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def is_own_origin(origin: str, host: str) -> bool:
    """Tell whether a page comes from the server that it speaks to.

    Examples
    --------
    >>> is_own_origin("http://127.0.0.1:8080", "127.0.0.1:8080"), is_own_origin("http://127.0.0.1:9", "127.0.0.1:8080")
    (True, False)
    >>> is_own_origin("null", "127.0.0.1:8080"), is_own_origin("http://[", "127.0.0.1:8080")
    (False, False)
    """
    return origin.lower() in (f"http://{host.lower()}", f"https://{host.lower()}")


def of_headers(listed: Iterable[tuple[bytes, bytes]]) -> dict[str, list[str]]:
    """Return the values of each header of a request, by its name in small letters."""
    headers: dict[str, list[str]] = {}
    for name, value in listed:
        headers.setdefault(name.decode("latin-1").lower(), []).append(value.decode("latin-1"))
    return headers


def with_headers(
    there: Iterable[tuple[bytes, bytes]], more: Iterable[tuple[bytes, bytes]]
) -> list[tuple[bytes, bytes]]:
    """Return the headers of an answer with more of them: what is there stays, and each cookie has a line of its own.

    Examples
    --------
    >>> with_headers([(b"Set-Cookie", b"a=1"), (b"x", b"1")], [(b"set-cookie", b"b=2"), (b"x", b"2")])
    [(b'Set-Cookie', b'a=1'), (b'x', b'1'), (b'set-cookie', b'b=2')]
    """
    plain = list(there)
    names = {name.lower() for name, _ in plain} - {b"set-cookie"}
    return [*plain, *(row for row in more if row[0].lower() not in names)]


class Guard:
    """Refuses what must not come in, before anything else sees it.

    Parameters
    ----------
    app : ASGI application
        App that is guarded.
    token : str
        Token that a client must know; empty where only this machine can connect.
    host : str
        Name at which it was asked to listen, which it answers to beside this machine's.
    port : int
        At which it listens.
    """

    def __init__(self, app: App, token: str = "", host: str = "", port: int = 0) -> None:
        self.app, self._token = app, token
        self._names = frozenset({"localhost", socket.gethostname().lower(), host.lower()})
        self._cookie = f"{COOKIE}-{port}"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what may come in, or say why not."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        status, reason = self._refusal(scope, of_headers(scope["headers"]))
        if reason:
            await _refuse(scope, send, status, reason)
            return
        await self.app(scope, _bounded(receive), self._sending(send, self._is_token(_token_of_address(scope))))

    def _refusal(self, scope: Scope, headers: dict[str, list[str]]) -> tuple[int, str]:
        """Return status and reason for what is not let in; an empty reason for what is."""
        twice = [name for name in ONCE if len(headers.get(name, ())) > 1]
        if twice:
            return 400, f"a request has one {twice[0]} header"
        host = headers.get("host", [""])[0]
        if not is_own_host(host, self._names):
            return 421, "this is strikewave on this machine, and it answers to its own address alone"
        if not all(is_own_origin(origin, host) for origin in headers.get("origin", ())):
            return 403, "a page of another origin may not speak to this server"
        if headers.get("sec-fetch-site") == ["cross-site"] and headers.get("sec-fetch-mode") != ["navigate"]:
            return 403, "a page of another origin may not speak to this server"
        if self._token and not self._knows_token(scope, headers):
            return 401, "open the whole address that strikewave printed when it started: it holds the token"
        if not _is_bounded(headers.get("content-length", ["0"])[0]):
            return 413, f"at most {LARGEST_UPLOAD >> 20} MB at a time: cut the file, or use `strikewave record` on it"
        return 200, ""

    def _knows_token(self, scope: Scope, headers: dict[str, list[str]]) -> bool:
        cookies = cookie_parser("; ".join(headers.get("cookie", ())))
        # a list: both are compared in any case
        return any([self._is_token(_token_of_address(scope)), self._is_token(cookies.get(self._cookie, ""))])

    def _is_token(self, word: str) -> bool:
        return bool(self._token) and hmac.compare_digest(word.encode(), self._token.encode())

    def _sending(self, send: Send, came_by_address: bool) -> Send:
        """Return what sends an answer with our headers, and with the token as a cookie for who came by its address."""
        more = list(HEADERS)
        if came_by_address:
            cookie = f"{self._cookie}={self._token}; HttpOnly; SameSite=Strict; Path=/"
            more.append((b"set-cookie", cookie.encode()))

        async def sent(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = with_headers(message.get("headers", ()), more)
            await send(message)

        return sent


def _token_of_address(scope: Scope) -> str:
    return parse_qs(scope.get("query_string", b"").decode("latin-1")).get("token", [""])[0]


def _is_bounded(length: str) -> bool:
    """Tell whether the length that a request states is a number, and not too large."""
    is_number = length.isascii() and length.isdecimal() and len(length) <= LONGEST_LENGTH
    return is_number and int(length) <= LARGEST_UPLOAD


def _bounded(receive: Receive) -> Receive:
    """Return what receives a request, and ends it where it is larger than it may be, whatever it said of its size."""
    size = 0

    async def received() -> MutableMapping[str, Any]:
        nonlocal size
        message = await receive()
        if message["type"] == "http.request":
            size += len(message.get("body", b""))
            if size > LARGEST_UPLOAD:
                return {"type": "http.disconnect"}
        return message

    return received


async def _refuse(scope: Scope, send: Send, status: int, reason: str) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 1008, "reason": reason})
        return
    headers = [(b"content-type", b"text/plain; charset=utf-8"), (b"connection", b"close"), *HEADERS]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": f"{reason}\n".encode()})
