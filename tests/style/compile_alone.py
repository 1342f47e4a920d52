#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compiles each C++ file by itself, headers too. The build compiles several sources at once, where a file may use what the one
before it includes; a file that does so breaks when another is moved or changed, far from the change.

Each file is compiled with the options that the build has for it, a header with those of a source that lies nearest to it; nothing is
written of it. Prints each file that does not compile with the first error, and last how many did; exit status 1 where one does not."""
import argparse
import json
import os
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# Not of the build, and why.
ELSEWHERE = {
    "bench/": "a project of its own, which compiles each file alone",
    "hls_kernels/": "with the integers of a toolset, by make test-hls; hls_kernels/generate is of the build",
    "tests/hls/shims/": "stand for a toolset's headers",
    "tests/hls/violations/": "kernels that must not compile, or not pass",
    "tests/tsan/": "stand for headers of oneTBB",
}
OF_THE_BUILD = ("hls_kernels/generate/",)


class Project:
    """A configured build without joined files."""

    def __init__(self, source: Path, build: Path) -> None:
        self.source, self.build = source, build
        self.run(["cmake", "-S", str(source), "-B", str(build), "-G", "Ninja", "-DPHOTONLOOM_UNITY=OFF", "-DBUILD_TESTING=ON",
                  "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"])
        entries = json.loads((build / "compile_commands.json").read_text())
        self.options: dict[str, list[str]] = {}
        generated = []
        for entry in entries:
            file = Path(entry["directory"], entry["file"])
            if file.is_relative_to(source) and not file.is_relative_to(build):
                self.options.setdefault(str(file.relative_to(source)), options_of(entry["command"]))
            elif not file.exists():
                generated.append(str(file.relative_to(build)))
        if generated:
            self.run(["ninja", "-C", str(build), *generated])  # with the headers beside them

    @staticmethod
    def run(command: list[str]) -> None:
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"compile_alone: {shlex.join(command)}: status {done.returncode}\n{done.stdout}{done.stderr}")

    def nearest(self, header: str) -> list[str]:
        """Options of the source that shares the longest path with a header; of several, the first by name."""
        return self.options[max(sorted(self.options), key=lambda file: len(os.path.commonpath([file, header])))]

    def compile(self, file: str) -> str:
        """What is wrong with a file, or nothing."""
        if file in self.options:
            command, text = [*self.options[file], "-fsyntax-only", str(self.source / file)], ""
        else:
            command, text = [*self.nearest(file), "-fsyntax-only", "-x", "c++", "-"], f'#include "{file}"\n'
        done = subprocess.run(command, input=text, capture_output=True, text=True, cwd=self.build)
        if done.returncode == 0:
            return ""
        said = [line for line in done.stderr.splitlines() if "error:" in line] or done.stderr.splitlines()
        return f"{file}: does not compile by itself: {said[0] if said else f'status {done.returncode}'}"


def options_of(command: str) -> list[str]:
    """Compiler and options, without the file and what it is compiled to."""
    words = shlex.split(command)
    return words[:words.index("-o")]


def listed(source: Path) -> list[str]:
    """The project's C++ files."""
    names = ["*.cpp", "*.hpp"]
    found = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", *names], cwd=source, capture_output=True,
                           text=True)
    if found.returncode == 0:
        return [file for file in found.stdout.split() if (source / file).is_file()]
    return sorted(str(path.relative_to(source)) for name in names for path in source.rglob(name)
                  if not str(path.relative_to(source)).startswith("build"))


def main() -> int:
    parser = argparse.ArgumentParser(prog="compile_alone", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=Path, help="folder of the project")
    parser.add_argument("build", type=Path, help="folder to configure it in")
    parser.add_argument("files", nargs="*", help="files, as git names them (default: all)")
    asked = parser.parse_args()
    source = asked.source.resolve()
    project = Project(source, asked.build.resolve())
    files = asked.files or [file for file in listed(source)
                            if not file.startswith(tuple(ELSEWHERE)) or file.startswith(OF_THE_BUILD)]
    of_no_target = [file for file in files if file.endswith(".cpp") and file not in project.options]
    wrong = [f"{file}: is not compiled by the build, expected so of every source but those in {', '.join(ELSEWHERE)}" for file in of_no_target]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        wrong += filter(None, pool.map(project.compile, (file for file in files if file not in of_no_target)))
    for sentence in wrong:
        print(sentence)
    print(f"{len(files) - len(wrong)} of {len(files)} files compile by themselves")
    return 1 if wrong or not files else 0


if __name__ == "__main__":
    sys.exit(main())
