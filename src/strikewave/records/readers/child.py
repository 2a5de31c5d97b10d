"""Read a file in a child process with limits, for formats whose libraries cannot be trusted with a hostile file.

A damaged file may crash a library written in C, make it take all memory, or never end. In a child process that is one
more file that cannot be read. Samples come back as plain float64 files, the rest as JSON; nothing is unpickled.
"""

from __future__ import annotations

import dataclasses
import importlib
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from strikewave.base.errors import InputError
from strikewave.base.processes import ONE_THREAD, environment, python_command
from strikewave.records.health_notice import HealthNotice
from strikewave.records.readers import FORMATS, LARGEST_ARRAY, Options
from strikewave.records.record import Channel, Record

MEMORY = 2**29  # bytes a child may take for a small file: libraries take 200 MB; larger files add `MEMORY_PER_BYTE`
# Bytes of memory for each byte of a file: two bytes become a double and its time stamp, packed data several times that
MEMORY_PER_BYTE = 100
# How long a child may take for a small file, s: importing its library takes some of them on a busy machine
SECONDS = 20.0
# Lowest rate at which a child must read a larger file, bytes/s: every library reads many times as fast
BYTES_PER_SECOND = 1e6
LONGEST_HINT = 200  # characters of a library's own words in an error: a line or two


def isolated(reader: str, path: Path, options: Options) -> Record:
    """Let a child process call ``parse_FORMAT`` of a format, and return its record.

    Its module has ``parse_FORMAT`` with the arguments and the result of ``read_FORMAT``.
    """
    size = path.stat().st_size
    seconds = SECONDS + size / BYTES_PER_SECOND
    with tempfile.TemporaryDirectory(prefix="strikewave-", ignore_cleanup_errors=True) as folder:
        task = {
            "reader": reader,
            "path": str(path.absolute()),
            "folder": folder,
            "options": options._asdict(),
            "memory": min(MEMORY + MEMORY_PER_BYTE * size, 2 * LARGEST_ARRAY),
            "seconds": math.ceil(seconds),
        }
        try:
            subprocess.run(
                python_command("-c", f"from {__name__} import work; work()"),
                input=json.dumps(task).encode(),
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                env=environment(**ONE_THREAD),
                timeout=seconds,
                check=True,
            )
            answer = json.loads((Path(folder) / "answer.json").read_text("utf-8"))
        except subprocess.TimeoutExpired:
            raise InputError("FILE", path, "a file that is whole", "reading it did not end") from None
        except (subprocess.CalledProcessError, OSError, ValueError):
            raise InputError("FILE", path, "a file that is whole", "its reader broke down") from None
        return _record(path, reader, Path(folder), answer)


def _record(path: Path, reader: str, folder: Path, answer: dict[str, Any]) -> Record:
    if "error" in answer:
        error = answer["error"]
        got = path if error["field"] == "FILE" else error["got"]
        raise InputError(error["field"], got, error["allowed"], error["hint"])
    stamps = [np.fromfile(folder / f"stamps{k}", np.float64) for k in range(answer["stamps"])]
    channels = []
    for k, channel in enumerate(answer["channels"]):
        size, stamps_of = channel.pop("size"), channel.pop("held")
        file = folder / f"values{k}"
        values = np.fromfile(file, np.float64) if size is None else np.broadcast_to(np.float64(np.nan), (size,))
        file.unlink(missing_ok=True)
        channels.append(Channel(values=values, stamps=None if stamps_of is None else stamps[stamps_of], **channel))
    findings = (HealthNotice(**{**finding, "harms": tuple(finding["harms"])}) for finding in answer["findings"])
    return Record(str(path), reader, tuple(channels), tuple(findings))


def work() -> None:
    """Do in the child what standard input asks for."""
    task = json.loads(sys.stdin.read())
    folder = Path(task["folder"])
    _limit(task["memory"], task["seconds"])
    stated = task["options"]
    options = Options(**{**stated, "channels": tuple(stated["channels"])})
    try:
        module = importlib.import_module(f"{__package__}.{FORMATS[task['reader']]}")
        record = getattr(module, f"parse_{task['reader']}")(Path(task["path"]), options)
        answer = _written(record, folder)
    except InputError as error:
        answer = _failed(str(error.got), error.allowed, error.hint)
        answer["error"]["field"] = error.field
    except MemoryError:
        answer = _failed(task["path"], "a file that fits into memory", "read fewer channels")
    except Exception as error:
        answer = _failed(task["path"], "a file that is whole", f"{type(error).__name__}: {error}"[:LONGEST_HINT])
    (folder / "answer.json").write_text(json.dumps(answer), "utf-8")
    sys.stdout.flush()
    os._exit(0)


def _failed(path: str, allowed: str, hint: str) -> dict[str, Any]:
    return {"error": {"field": "FILE", "got": path, "allowed": allowed, "hint": hint}}


def _limit(memory: int, seconds: int) -> None:
    """Bound memory, and time too: of a first process that was killed, nobody else ends a reader that hangs."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_DATA, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _written(record: Record, folder: Path) -> dict[str, Any]:
    stamps_by_id: dict[int, int] = {}
    channels: list[dict[str, Any]] = []
    for k, channel in enumerate(record.channels):
        absent = channel.values.strides == (0,) and channel.values.size > 1
        if not absent:
            channel.values.tofile(folder / f"values{k}")
        if channel.stamps is not None and id(channel.stamps) not in stamps_by_id:
            stamps_by_id[id(channel.stamps)] = len(stamps_by_id)
            channel.stamps.tofile(folder / f"stamps{stamps_by_id[id(channel.stamps)]}")
        channels.append(
            {
                "name": channel.name,
                "step": channel.step,
                "start": channel.start,
                "unit": channel.unit,
                "size": channel.values.size if absent else None,
                "held": stamps_by_id.get(id(channel.stamps)) if channel.stamps is not None else None,
            }
        )
    return {
        "channels": channels,
        "stamps": len(stamps_by_id),
        "findings": [dataclasses.asdict(finding) for finding in record.findings],
    }
