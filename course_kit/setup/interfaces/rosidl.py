"""Compile .msg, .srv and .action files into importable ROS packages, with the rosidl generators and no CMake.

Runs at install time, inside the build environment of pip or uv. Each package becomes Python modules and three
shared libraries beside them:

    lib<package>__rosidl_typesupport_fastrtps_c.so       C structs and their Fast DDS serialisation
    lib<package>__rosidl_typesupport_introspection_c.so  the fields, described for rmw_fastrtps at run time
    <package>_s__rosidl_typesupport_c.so                 conversion between Python and C, imported by rclpy
"""

from __future__ import annotations

import importlib
import json
import multiprocessing
import os
import re
import subprocess
import sysconfig
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

from course_kit.setup.environment import compiler
from course_kit.setup.environment.compiler import Compiler

KINDS = ("msg", "srv", "action")
# Services and actions use types of these packages without naming them in their definition; package.xml names others.
DEPENDENCIES = ("action_msgs", "builtin_interfaces", "service_msgs", "unique_identifier_msgs")
FASTRTPS = "rosidl_typesupport_fastrtps_c"
INTROSPECTION = "rosidl_typesupport_introspection_c"
GENERATORS = ("rosidl_generator_py", "rosidl_generator_c", FASTRTPS, "rosidl_typesupport_c", INTROSPECTION)


def ros_prefix() -> Path:
    """Where include/, lib/ and share/ of the ROS packages are."""
    module = importlib.import_module("rosidl_pycommon")
    return Path(str(module.__file__)).resolve().parents[4]


def dependencies(source: Path) -> list[str]:
    """The packages whose types one with this folder may use, each once."""
    manifest = source / "package.xml"
    named = re.findall(r"<depend>\s*(\w+)\s*</depend>", manifest.read_text()) if manifest.exists() else []
    return list(dict.fromkeys((*DEPENDENCIES, *named)))


def build(packages: dict[str, Path], work: Path) -> dict[str, Path]:
    """Build packages {name: folder with msg/, srv/, action/}; return {name: folder to install as a module}.

    `work` also receives share/<package> with the .idl files and the type descriptions with their hashes.
    Raises compiler.CompileError if there is no compiler, CalledProcessError if compiling fails.
    """
    work = work.resolve()
    work.mkdir(parents=True, exist_ok=True)
    tools = compiler.find(work)
    return _compile(packages, _generate(packages, work), tools, work)


Generated = dict[str, dict[str, list[str]]]  # package -> generator -> files written


def _generate(packages: dict[str, Path], work: Path) -> Generated:
    """Run every generator of every package, as many at once as there are cores."""
    context = multiprocessing.get_context("fork")
    with ProcessPoolExecutor(os.cpu_count(), context, _discard_stdout) as pool:
        described = {name: pool.submit(_describe, name, path.resolve(), work) for name, path in packages.items()}
        runs = {
            (name, generator): pool.submit(_run_generator, generator, arguments, work)
            for name, description in described.items()
            for generator, arguments in description.result().items()
        }
        return {name: {g: sorted({str(f) for f in runs[name, g].result()}) for g in GENERATORS} for name in packages}


def _discard_stdout() -> None:
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # the generators announce every file they read


def _describe(package: str, source: Path, work: Path) -> dict[str, dict[str, Any]]:
    """Turn definitions into .idl and type descriptions (with RIHS01 hashes); return each generator's arguments."""
    adapter = importlib.import_module("rosidl_adapter")
    share = ros_prefix() / "share"
    files = sorted(p.relative_to(source) for kind in KINDS for p in (source / kind).glob(f"*.{kind}"))
    out = work / "share" / package
    idls = [adapter.convert_to_idl(source, package, file, out).relative_to(out) for file in files]
    common = {
        "package_name": package,
        "idl_tuples": [f"{out}:{idl}" for idl in idls],
        "ros_interface_files": [str(source / file) for file in files],
        "include_paths": [f"{name}:{share / name}" for name in dependencies(source)],
        "target_dependencies": [],
        "output_dir": str(out),
    }
    _run_generator("rosidl_generator_type_description", common, work)
    common["type_description_tuples"] = [f"{idl}:{out / idl.with_suffix('.json')}" for idl in idls]
    return {
        name: common | {"template_dir": str(share / name / "resource"), "output_dir": str(work / name / package)}
        for name in GENERATORS
    }


def _run_generator(name: str, arguments: dict[str, Any], work: Path) -> list[str]:
    """Call one rosidl generator; return the files it wrote."""
    out = Path(arguments["output_dir"])
    out.mkdir(parents=True, exist_ok=True)
    arguments_file = work / f"{arguments['package_name']}__{name}.json"
    arguments_file.write_text(json.dumps(arguments))
    module = importlib.import_module(name)
    if name == "rosidl_generator_type_description":
        return module.generate_type_hash(str(arguments_file))
    if name == "rosidl_generator_py":
        return module.generate_py(str(arguments_file), ["rosidl_typesupport_c"])
    if name == "rosidl_typesupport_c":
        return module.generate_c(str(arguments_file), [FASTRTPS, INTROSPECTION])
    _write_visibility_header(name, arguments["package_name"], out)
    if name == FASTRTPS:
        return module.generate_typesupport_fastrtps_c(str(arguments_file))
    return module.generate_c(str(arguments_file))


def _write_visibility_header(generator: str, package: str, out: Path) -> None:
    """Fill in the header that CMake would have configured."""
    template = ros_prefix() / "share" / generator / "resource" / f"{generator}__visibility_control.h.in"
    header = out / "msg" / template.stem
    header.parent.mkdir(exist_ok=True)
    text = template.read_text().replace("@PROJECT_NAME_UPPER@", package.upper())
    header.write_text(text.replace("@PROJECT_NAME@", package))


def _compile(packages: dict[str, Path], generated: Generated, compiler: Compiler, work: Path) -> dict[str, Path]:
    """Compile and link what the generators wrote."""
    numpy = importlib.import_module("numpy")
    prefix = ros_prefix()
    include = [
        *(work / generator for generator in GENERATORS),
        prefix / "include",
        *(p for p in (prefix / "include").iterdir() if p.is_dir() and not p.name.startswith("python")),
        sysconfig.get_path("include"),
        sysconfig.get_path("platinclude"),
        numpy.get_include(),
    ]
    flags = ["-O1", "-fPIC", "-w", *(f"-I{path}" for path in dict.fromkeys(map(str, include)))]
    objects_folder = work / "obj"
    objects_folder.mkdir(exist_ok=True)

    def compile_source(source: Path) -> str:
        output = objects_folder / (str(source.relative_to(work)).replace("/", "_") + ".o")
        command = compiler.c if source.suffix == ".c" else [*compiler.cxx, "-std=c++17"]
        subprocess.run([*command, *flags, "-c", source, "-o", output], check=True)
        return str(output)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        objects = {
            package: [[pool.submit(compile_source, s) for s in sources] for sources in _sources(package, files, work)]
            for package, files in generated.items()
        }
        compiled = {p: [[f.result() for f in group] for group in groups] for p, groups in objects.items()}
    return {
        package: _link(package, groups, dependencies(packages[package]), compiler, work)
        for package, groups in compiled.items()
    }


def _sources(package: str, files: dict[str, list[str]], work: Path) -> list[list[Path]]:
    """The sources of the three libraries. Many small files become one translation unit: much faster to compile."""

    def unit(generator: str, ending: str) -> Path:
        path = work / f"{package}__{generator}__unit{ending.replace('/', '_')}"
        sources = [name for name in files[generator] if name.endswith(ending)]
        path.write_text("".join(f'#include "{name}"\n' for name in sources))
        return path

    c_files = [Path(f) for f in files["rosidl_generator_c"] if f.endswith("__description.c")]
    extension_modules = [Path(f) for f in files["rosidl_generator_py"] if ".ep." in f]
    fastrtps = [
        unit(FASTRTPS, ".cpp"),
        unit("rosidl_generator_c", "__functions.c"),
        unit("rosidl_generator_c", "__type_support.c"),
        *c_files,
    ]
    introspection = [unit(INTROSPECTION, ".c")]
    python = [unit("rosidl_generator_py", "_s.c"), unit("rosidl_typesupport_c", ".cpp"), *extension_modules]
    return [fastrtps, introspection, python]


def _link(package: str, objects: list[list[str]], used: list[str], compiler: Compiler, work: Path) -> Path:
    """Link the three libraries of a package into its module folder."""
    folder = work / "rosidl_generator_py" / package
    (folder / "__init__.py").touch()
    library_folder = ros_prefix() / "lib"

    def of_dependencies(*kinds: str) -> list[str]:
        return [f"{dependency}__{kind}" for dependency in used for kind in kinds]

    def link(name: str, objects: list[str], own: list[str], libraries: list[str]) -> None:
        # Own libraries are needed at run time although no symbol of them is used: --no-as-needed.
        subprocess.run(
            [
                *compiler.link, "-Wl,-rpath,$ORIGIN", f"-Wl,-soname,{name}",
                "-o", folder / name, *objects, f"-L{folder}", f"-L{library_folder}",
                "-Wl,--no-as-needed", *(f"-l{library}" for library in own),
                "-Wl,--as-needed", *(f"-l{library}" for library in libraries),
            ],
            check=True,
        )  # fmt: skip

    fastrtps, introspection = f"{package}__{FASTRTPS}", f"{package}__{INTROSPECTION}"
    runtime = ["rosidl_runtime_c", FASTRTPS, "rosidl_typesupport_fastrtps_cpp", "fastcdr"]
    link(f"lib{fastrtps}.so", objects[0], [], runtime + of_dependencies("rosidl_generator_c", FASTRTPS))
    link(f"lib{introspection}.so", objects[1], [fastrtps], [INTROSPECTION, *of_dependencies(INTROSPECTION)])
    conversion = ["rosidl_typesupport_c", *of_dependencies("rosidl_typesupport_c", "rosidl_generator_py")]
    link(f"{package}_s__rosidl_typesupport_c.so", objects[2], [fastrtps, introspection], conversion)
    return folder
