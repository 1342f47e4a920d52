# SPDX-License-Identifier: Apache-2.0
"""compile_alone.py on a project of four files."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = Path(__file__).with_name("compile_alone.py")
FILES = {
    "CMakeLists.txt": "cmake_minimum_required(VERSION 3.25)\nproject(four LANGUAGES CXX)\noption(PHOTONLOOM_UNITY \"\" ON)\n"
                      "add_library(four a.cpp b.cpp)\ntarget_include_directories(four PRIVATE .)\n"
                      "set_target_properties(four PROPERTIES UNITY_BUILD ${PHOTONLOOM_UNITY})\n",
    "size.hpp": "#pragma once\n#include <vector>\ninline std::size_t size_of(const std::vector<int>& v) { return v.size(); }\n",
    "text.hpp": "#pragma once\n#include <string>\ninline std::string text() { return \"\"; }\n",
    "a.cpp": "#include \"size.hpp\"\nstd::size_t one() { return size_of({1}); }\n",
    "b.cpp": "#include \"text.hpp\"\nstd::string two() { return text(); }\n",
}


class CompileAlone(unittest.TestCase):
    def compiled(self, changed: dict[str, str], *files: str) -> tuple[int, str]:
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder, "source")
            source.mkdir()
            for name, text in {**FILES, **changed}.items():
                (source / name).write_text(text)
            done = subprocess.run([sys.executable, str(PROGRAM), str(source), str(Path(folder, "build")), *files], capture_output=True,
                                  text=True)
            return done.returncode, done.stdout + done.stderr

    def test_all_compile(self) -> None:
        self.assertEqual(self.compiled({}), (0, "4 of 4 files compile by themselves\n"))

    def test_a_source_that_uses_what_its_neighbour_includes(self) -> None:
        status, said = self.compiled({"b.cpp": "#include \"text.hpp\"\nstd::size_t two() { return size_of({}); }\n"})
        self.assertEqual(status, 1)
        self.assertIn("b.cpp: does not compile by itself: ", said)
        self.assertIn("size_of", said)
        self.assertIn("3 of 4 files", said)

    def test_a_header_that_includes_too_little(self) -> None:
        status, said = self.compiled({"text.hpp": "#pragma once\ninline std::string text() { return \"\"; }\n",
                                      "b.cpp": "#include <string>\n#include \"text.hpp\"\n"})
        self.assertEqual(status, 1)
        self.assertIn("text.hpp: does not compile by itself: ", said)
        self.assertIn("3 of 4 files", said)

    def test_a_source_that_no_target_has(self) -> None:
        status, said = self.compiled({"c.cpp": ""})
        self.assertEqual(status, 1)
        self.assertIn("c.cpp: is not compiled by the build, expected so", said)

    def test_chosen_files(self) -> None:
        self.assertEqual(self.compiled({"text.hpp": "#pragma once\nstd::string text();\n"}, "size.hpp", "a.cpp"),
                         (0, "2 of 2 files compile by themselves\n"))


if __name__ == "__main__":
    unittest.main()
