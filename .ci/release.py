"""Make a release of this commit: version, change log, tag, wheel and source archive in dist/. Nothing is uploaded.

    make release VERSION=0.2.0

runs the tests first. The tree must be clean, and CHANGELOG.md must have the section "## 0.2.0 (not yet released)".
"""

import datetime
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent


def release(version: str, root: Path, today: datetime.date) -> None:
    """Write the version where it stands, commit and tag it, and build what would be uploaded."""
    if not re.fullmatch(r"\d+\.\d+\.\d+", version):
        sys.exit(f"VERSION is {version!r}; it must be three numbers, such as 0.2.0")
    if _git(root, "status", "--porcelain"):
        sys.exit("the tree has changes that are not committed")
    if _git(root, "tag", "--list", f"v{version}"):
        sys.exit(f"the tag v{version} is there already")
    log = root / "CHANGELOG.md"
    if f"## {version} (not yet released)" not in log.read_text():
        sys.exit(f"CHANGELOG.md has no section '## {version} (not yet released)'")
    _replace(log, rf"## {re.escape(version)} \(not yet released\)", f"## {version} ({today})")
    _replace(root / "pyproject.toml", r'(?m)^version = ".*"$', f'version = "{version}"')
    _replace(root / ".ci" / "conda" / "recipe.yaml", r'(?m)^  version: ".*"$', f'  version: "{version}"')
    _replace(root / "CITATION.cff", r"(?m)^version: .*$", f"version: {version}")
    _replace(root / "CITATION.cff", r"(?m)^date-released: .*$", f"date-released: {today}")
    _git(root, "commit", "--all", "--message", f"Release {version}")
    _git(root, "tag", "--annotate", f"v{version}", "--message", f"roughmdr {version}")
    subprocess.run([sys.executable, "-m", "hatchling", "build", "--directory", "dist"], cwd=root, check=True)
    print(f"dist/ holds roughmdr {version}. To publish: git push --follow-tags, and upload what is in dist/.")


def _git(root: Path, *arguments: str) -> str:
    return subprocess.run(["git", *arguments], cwd=root, check=True, capture_output=True, text=True).stdout.strip()


def _replace(file: Path, pattern: str, new: str) -> None:
    text, count = re.subn(pattern, new, file.read_text())
    if count != 1:
        sys.exit(f"{file.name} has {count} places for {new!r}; it must have one")
    file.write_text(text)


if __name__ == "__main__":
    release(sys.argv[1] if len(sys.argv) > 1 else "", ROOT, datetime.datetime.now(datetime.UTC).date())
