"""Compile kernels with numba and keep them on disk between runs.

The compiled code lies in the user's cache folder under a key made of every kernel's source, so a
changed kernel is never answered from an old cache. Where no folder can be written a warning
is given, and the kernels are compiled anew in each process.

Files of compiled kernels: in a folder that nobody else can write, and each with a check sum. They are pickles, with
machine code in them: to read one is to run it. So the folder is the user's own; and a file that a full disk or a
fault of the disk has damaged is dropped, and its kernel compiled anew.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import pickle
import shutil
import stat
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar, TypeVar, cast

import llvmlite.binding as llvm
import numba
import platformdirs
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile, UserProvidedCacheLocator
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, compile_result
from numba.core.registry import CPUDispatcher
from numba.core.runtime import _nrt_python  # type: ignore[attr-defined]

from strikewave.base.errors import InputError, StrikewaveWarning

F = TypeVar("F", bound=Callable[..., Any])
PACKAGE = Path(__file__).absolute().parents[1]
"""Folder of the package: kernels are told apart by their place in it, wherever it lies."""
KEY_DIGITS = 16
"""Digits of the key of a folder of kernels: of 64 bits no two versions are alike, and the path stays short."""
FULL: Any = {"forceinline": False, "no_cfunc_wrapper": True}
"""Numba's options of every kernel. It is inlined only where that is asked for: left unsaid, numba hands the wish of the
kernel that first calls it down to it, and copies large ones wherever they are called. Nothing calls kernels by pointers
of C, so that such an entry, one more copy of what is inlined, is left out. Both make compiling shorter, not results
different."""
CALLED: Any = {**FULL, "_nrt": False}
"""Numba's options of a large kernel that makes no array."""
FUSED = {"contract", "arcp"}
"""Liberties of LLVM with the formulas of fused kernels: round a product and a sum once together, and multiply by a
rounded 1/b where it divides by b. Either is off by a rounding or two."""
LOCATORS = ("UserWideCacheLocator", "IPythonCacheLocator", "ZipCacheLocator")
"""Numba's own, for kernels that come from no plain file: a frozen program, a notebook, a zipped package."""


def kernel_sources(package: Path) -> list[Path]:
    """Return the files of a package folder that machine code is made of: kernels, what keeps them, their constants."""
    beside = ("base/compiled.py", "signal/pulse.py")  # the last has the levels of a pulse
    return sorted([*package.glob("**/_[a-z]*.py"), *(package / name for name in beside)])


def kernel_key(package: Path) -> str:
    """Return a key made of numba's version and the source of every kernel in a package folder."""
    digest = hashlib.sha256(numba.__version__.encode())
    for source in kernel_sources(package):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:KEY_DIGITS]


def is_cold(name: str = "") -> bool:
    """Tell whether the kernels, or the one with a name, have to be compiled before the first run."""
    folder = cache_folder()
    pattern = f"*{name}*.nbi" if name else "*.nbi"
    return folder is None or next(Path(folder).rglob(pattern), None) is None


@functools.cache
def cache_folder() -> str | None:
    """Return the folder that holds compiled kernels, or None when none can be written.

    ``NUMBA_CACHE_DIR`` is used when it is set, and the user's cache folder otherwise.
    """
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    base = Path(chosen) if chosen else Path(platformdirs.user_cache_dir("strikewave", appauthor=False))
    folder = base / f"kernels-{kernel_key(PACKAGE)}"
    try:
        own_folder(folder)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        warnings.warn(
            f"compiled kernels cannot be kept in {folder} ({error.strerror}); each run compiles them anew "
            "(about 10 s). Set NUMBA_CACHE_DIR to a folder that can be written.",
            StrikewaveWarning,
            stacklevel=2,
        )
        return None
    return str(folder)


def kernel(function: F) -> F:
    """Compile a function with numba on its first call and keep the result on disk.

    Examples
    --------
    >>> @kernel
    ... def double(x):
    ...     return 2.0 * x
    >>> double(2.0)
    4.0
    """
    return _compiled(function, FULL)


def leaf_kernel(function: F) -> F:
    """Compile a kernel that makes no array as a part of those that call it, inlined and without counting references.

    In small loops either halves the time.
    """
    return _part(function, LEAF)


def called_kernel(function: F) -> F:
    """Compile a kernel that makes no array, without counting references, but call it instead of inlining it.

    For what stands in many loops and is large: it compiles once.
    """
    return _compiled(function, CALLED)


def inner_kernel(function: F) -> F:
    """Compile a `called_kernel` as a part of the kernels that call it: for what Python hardly ever calls."""
    return _part(function, INNER)


def fused_kernel(function: F) -> F:
    """Compile a kernel whose products and sums may be rounded once together (fused multiply-add); see `FUSED`."""
    return _compiled(function, {**FULL, "fastmath": FUSED})


def fused_leaf_kernel(function: F) -> F:
    """Compile a `leaf_kernel` whose products and sums may be rounded once together."""
    return _compiled(function, {**CALLED, "forceinline": True, "fastmath": FUSED})


def fused_called_kernel(function: F) -> F:
    """Compile a `called_kernel` whose products and sums may be rounded once together, into the widest vectors."""
    return _compiled(function, WIDE)


class _PartLibrary(JITCodeLibrary):
    """Code of a part, as numba wrote it: neither optimized nor made into machine code.

    LLVM does both for the kernel that Python calls, with all of its parts. Numba does them for each kernel, and for all
    that it calls, again: most of the time of compiling, for machine code that nothing runs.
    """

    @classmethod
    def kept(cls, codegen: Any, name: str, bitcode: bytes) -> _PartLibrary:
        """Return the library that was kept as bitcode."""
        library = cls(codegen, name)
        library._final_module = llvm.parse_bitcode(bitcode)
        library._finalized = True
        return library

    def enable_object_caching(self) -> None:
        """Do nothing: what is kept is the bitcode."""

    def bitcode(self) -> bytes:
        """Return the code for linking."""
        return bytes(self._get_module_for_linking().as_bitcode())

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0: there is no machine code."""
        self._ensure_finalized()
        return 0

    @property
    def codegen(self) -> _PartLibrary:
        """Return what numba then tells the function's environment."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing: the environment would be written into the machine code."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


class _OwnCompiler(Compiler):
    """Numba's compiler, into a library of a kind of its own."""

    library: ClassVar[type[JITCodeLibrary]]

    def compile_extra(self, func: Any) -> Any:
        self.state.library = self.library(self.state.targetctx.codegen(), func.__qualname__)
        self.state.library.enable_object_caching()
        return super().compile_extra(func)


class _PartCompiler(_OwnCompiler):
    library = _PartLibrary


class _Part(CPUDispatcher):
    """A kernel that is a part of others. Where Python calls it after all, it is compiled once more, as a whole."""

    def __call__(self, *arguments: Any) -> Any:
        return self._whole(*arguments)

    @functools.cached_property
    def _whole(self) -> Any:
        return _compiled(self.py_func, CALLED)

    def add_overload(self, result: Any) -> None:
        """Note what was compiled for kernels, and not for Python, which would call it at address 0."""
        self.overloads[tuple(result.signature.args)] = result


LEAF: Any = {**CALLED, "forceinline": True, "no_cpython_wrapper": True, "pipeline_class": _PartCompiler}
"""Numba's options of a `leaf_kernel`: in small loops counting references and calling cost half the time."""
INNER: Any = {**LEAF, "forceinline": False}
"""Numba's options of an `inner_kernel`."""


class _WideLibrary(JITCodeLibrary):
    """Code whose vector loops take the widest registers of the processor.

    LLVM takes half of them where a processor may slow its clock down for whole ones. A loop that does little else than
    calculate gains a tenth all the same.
    """

    def add_ir_module(self, module: Any) -> None:
        """Take a module of numba's, with a wish on each of its functions."""
        for function in module.functions:
            set.add(function.attributes, '"prefer-vector-width"="512"')  # llvmlite's own `add` knows no such wishes
        super().add_ir_module(module)


class _WideCompiler(_OwnCompiler):
    library = _WideLibrary


WIDE: Any = {**CALLED, "pipeline_class": _WideCompiler, "fastmath": FUSED}
"""Numba's options of a `fused_called_kernel`."""


class KernelLocator(UserProvidedCacheLocator):
    """Locate a kernel on disk: by its place within the package, not by where the package lies.

    The folder's own key holds the source of all kernels, so that a second environment, or a fresh clone with the same
    kernels, takes what the first one compiled.
    """

    @classmethod
    def get_suitable_cache_subpath(cls, py_file: str) -> str:
        """Return the folder of a module's kernels; of one outside the package what numba takes."""
        path = Path(py_file).absolute()
        if not path.is_relative_to(PACKAGE):
            return str(super().get_suitable_cache_subpath(py_file))
        return ".".join(path.relative_to(PACKAGE).with_suffix("").parts)

    def get_source_stamp(self) -> Any:
        """Return nothing for a module of the package, whose text is in the folder's key: a clone's files are newer."""
        within = Path(self._py_file).absolute().is_relative_to(PACKAGE)
        return "" if within else super().get_source_stamp()


class _LoadedLibrary(JITCodeLibrary):
    """Machine code from disk. What another kernel would link is read only where one that calls it is compiled."""

    _bitcode = b""

    @classmethod
    def loaded(cls, codegen: Any, name: str, machine_code: bytes, bitcode: bytes, symbols: set[str]) -> _LoadedLibrary:
        """Return the library, ready to run."""
        library = cls(codegen, name)
        library._bitcode = bitcode
        library.enable_object_caching()
        library._set_compiled_object(machine_code)
        library._finalize_final_module()
        codegen._engine._defined_symbols |= symbols
        return library

    def _get_module_for_linking(self) -> Any:
        if self._shared_module is None:
            self._shared_module = llvm.parse_bitcode(self._bitcode)
        return self._shared_module


class _KeptKernels(CompileResultCacheImpl):
    """Storage of a kernel: that of numba, with less to read before the kernel runs.

    Numba reads what other kernels would link at once, and imports its own modules for the sake of constants that they
    do not have: two thirds of the time of loading.
    """

    def reduce(self, result: Any) -> Any:
        library, module = result.library, result.library._get_module_for_linking()
        symbols = {
            one.name for group in (module.functions, module.global_variables) for one in group if not one.is_declaration
        }
        code = library.name, library._get_compiled_object(), bytes(module.as_bitcode()), symbols
        return code, *_kept(result), [one for one in result._find_referenced_environments() if one.consts]

    def rebuild(self, target_context: Any, payload: Any) -> Any:
        code, *kept, environments = payload
        result = _rebuilt(target_context, _LoadedLibrary.loaded(target_context.codegen(), *code), *kept)
        for one in environments:
            target_context.codegen().set_env(one.env_name, one)
        return result


class _KeptParts(CompileResultCacheImpl):
    """Storage of a part: bitcode in a file of its own, beside that of the whole kernel."""

    def get_filename_base(self, fullname: str, abiflags: str) -> str:
        return f"{super().get_filename_base(fullname, abiflags)}.part"

    def reduce(self, result: Any) -> Any:
        return result.library.name, result.library.bitcode(), *_kept(result)

    def rebuild(self, target_context: Any, payload: Any) -> Any:
        name, bitcode, *kept = payload
        return _rebuilt(target_context, _PartLibrary.kept(target_context.codegen(), name, bitcode), *kept)


def _kept(result: Any) -> tuple[Any, Any, Any]:
    """Return what is kept of a compiled kernel beside its code."""
    result.fndesc.typemap = result.fndesc.calltypes = None  # as numba does: they cannot be pickled
    return result.fndesc, result.environment, result.signature


def _rebuilt(target_context: Any, library: Any, fndesc: Any, environment: Any, signature: Any) -> Any:
    """Return a compiled kernel of code and what `_kept` returned."""
    return compile_result(
        target_context=target_context,
        typing_context=target_context.typing_context,
        library=library,
        environment=environment,
        entry_point=target_context.get_executable(library, fndesc, environment),
        fndesc=fndesc,
        signature=signature,
        objectmode=False,
        lifted=(),
        reload_init=[],
    )


@functools.cache
def _name_runtime() -> None:
    """Tell the linker where the functions are that count references."""
    for name, address in _nrt_python.c_helpers.items():
        llvm.add_symbol(name if name.startswith("_") else f"NRT_{name}", address)


class _KernelCache(FunctionCache):
    """Load kernels without numba's registries of types and functions: to fill them takes longer than to load kernels.

    Where a kernel has to be compiled, numba's compiler fills its registries itself.
    """

    _impl_class: Any = _KeptKernels

    def __init__(self, function: Any) -> None:
        super().__init__(function)
        files = self._cache_path, self._impl.filename_base, self._impl.locator.get_source_stamp()
        self._cache_file: Any = KernelFiles(*files)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return a kernel for arguments of some types, or None where none is kept."""
        _name_runtime()
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a kernel; what the disk refuses is reported, and compiled anew in the next process.

        So is one that an interrupt left without code to keep, which LLVM hands over in a call from C: the interrupt
        comes again (`strikewave.base.processes`).
        """
        try:
            super().save_overload(sig, data)
        except OSError as error:
            report_unkept(self._cache_path, error)
        except RuntimeError as error:
            if "no compiled object" not in str(error):
                raise


class _PartCache(_KernelCache):
    _impl_class: Any = _KeptParts


def _part(function: F, options: dict[str, Any]) -> F:
    compiled: Any = _compiled(function, options, _PartCache)
    compiled.__class__ = _Part
    return cast(F, compiled)


def _compiled(function: F, options: dict[str, Any], cache: type[_KernelCache] = _KernelCache) -> F:
    settings: Any = numba.config
    if settings.DISABLE_JIT:  # a system's functions are found by its type, which only the compiler does
        raise InputError(
            "NUMBA_DISABLE_JIT", settings.DISABLE_JIT, "0, or unset: kernels run only where they are compiled"
        )
    folder = cache_folder()
    before = settings.CACHE_DIR, settings.CACHE_LOCATOR_CLASSES
    compiled: Any
    try:
        if folder is not None:
            settings.CACHE_DIR = folder
            settings.CACHE_LOCATOR_CLASSES = ",".join(
                [f"{__name__}.{KernelLocator.__name__}", *(f"numba.core.caching.{name}" for name in LOCATORS)]
            )
        compiled = numba.njit(error_model="numpy", nogil=True, **options)(function)
        if folder is not None:
            with contextlib.suppress(RuntimeError):  # a function without a source file (typed into a console) has none
                compiled._cache = cache(function)
    finally:
        settings.CACHE_DIR, settings.CACHE_LOCATOR_CLASSES = before
    return cast(F, compiled)


PRIVATE = 0o700
"""Mode of the folder: its owner reads and writes, nobody else sees it."""
WRITTEN_BY_OTHERS = stat.S_IWGRP | stat.S_IWOTH
"""Bits of a mode by which others may have put files there."""
CHECK = hashlib.sha256().digest_size
"""Bytes of the check sum at the beginning of a file."""


def own_folder(folder: Path) -> None:
    """Make a folder that is the user's own, or see to it that it is: emptied where others could write there.

    Raises
    ------
    OSError
        If it cannot be made, is no folder, or belongs to someone else.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    folder.mkdir(mode=PRIVATE, exist_ok=True)
    if not hasattr(os, "geteuid"):
        return
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.geteuid():
        raise PermissionError(0, "it belongs to another user, or is a link")
    if found.st_mode & WRITTEN_BY_OTHERS:
        shutil.rmtree(folder)
        folder.mkdir(mode=PRIVATE)
    elif stat.S_IMODE(found.st_mode) != PRIVATE:
        folder.chmod(PRIVATE)


class KernelFiles(IndexDataCacheFile):
    """Index and data of the kernels of a function, as numba keeps them, behind a check sum.

    Numba itself takes what a file holds on trust: emptied, cut or with another bit it stops each later run, by an error
    of pickle or a crash.
    """

    def _load_index(self) -> Any:
        held = self._checked(self._index_path)
        if held is None or held[:2] != (self._version, self._source_stamp):
            return {}
        return held[2]

    def _save_index(self, overloads: Any) -> None:
        self._write(self._index_path, (self._version, self._source_stamp, overloads))

    def _load_data(self, name: str) -> Any:
        return self._checked(self._data_path(name))

    def _save_data(self, name: str, data: Any) -> None:
        self._write(self._data_path(name), data)

    def _write(self, path: str, held: Any) -> None:
        body = self._dump(held)
        with self._open_for_write(path) as file:
            file.write(hashlib.sha256(body).digest() + body)

    def _checked(self, path: str) -> Any:
        """Return what a file holds; None where it is not there or was damaged, which removes it."""
        try:
            whole = Path(path).read_bytes()
        except OSError:
            return None
        check, body = whole[:CHECK], whole[CHECK:]
        if hashlib.sha256(body).digest() == check:
            return pickle.loads(body)
        Path(path).unlink(missing_ok=True)
        _warn(f"compiled kernels in {Path(path).parents[1]} were damaged; those are dropped, and compiled anew")
        return None


def report_unkept(folder: str, error: OSError) -> None:
    """Warn, once, that compiled kernels could not be kept in the folder of a module."""
    _warn(
        f"compiled kernels cannot be kept in {Path(folder).parent} ({error.strerror}); runs compile anew what is "
        "missing there. Free some room, or set NUMBA_CACHE_DIR to a folder that can be written"
    )


@functools.cache
def _warn(message: str) -> None:
    warnings.warn(message, StrikewaveWarning, stacklevel=3)
