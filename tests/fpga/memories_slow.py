# SPDX-License-Identifier: Apache-2.0
"""Block RAMs of the tops of docs/headline.md, predicted and synthesized, of all rows."""
import unittest

import flow_test


class OfAllRows(unittest.TestCase):
    def test_block_rams(self) -> None:
        flow_test.BoardMemories("compare").compare(None)


if __name__ == "__main__":
    unittest.main()
