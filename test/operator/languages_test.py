#!/usr/bin/python3
"""The page's languages: every word, every fault, and sentences with the places of their originals."""
import json
import re
import sys
import unittest

import rosunit
from page_rig import PAGE, ROOT


class Languages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.words = {f.stem: json.loads(f.read_text()) for f in (PAGE / "languages").glob("*.json")}

    def test_every_language_has_every_word(self):
        base = set(self.words["en"])
        for code, words in self.words.items():
            own = {key for key in words if not key.startswith("fault.")}
            self.assertEqual(base, own, code)

    def test_every_fault_of_the_machine_has_its_sentence_in_every_other_language(self):
        faults = re.findall(r"^\| \d+ \| `(\w+)` \|", (ROOT / "docs" / "safety.md").read_text(), re.MULTILINE)
        self.assertGreater(len(faults), 40)
        for code, words in self.words.items():
            missing = [] if code == "en" else [f for f in faults if f"fault.{f}" not in words]
            self.assertEqual([], missing, f"add them to operator/languages/{code}.json")

    def test_the_page_uses_words_that_there_are(self):
        text = "".join(f.read_text() for f in PAGE.glob("*.*"))
        used = set(re.findall(r'data-(?:text|say)="([\w.]+)"', text)) | set(re.findall(r"\btext\(\"([\w.]+)\"", text))
        self.assertEqual(set(), used - set(self.words["en"]))
        self.assertGreater(len(used), 60)

    def test_translated_sentences_have_the_places_of_their_originals(self):
        for code, words in self.words.items():
            for original, translated in words["sentences"].items():
                self.assertLessEqual(set(re.findall(r"\{\d\}", translated)), set(re.findall(r"\{\d\}", original)), (code, original))


if __name__ == "__main__":
    rosunit.unitrun("knee_robot", "operator_languages", "languages_test", sys.argv)
