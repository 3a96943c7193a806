"""Many mutants in one program: every function carries its mutants beside its own body, and the environment says which
one is obeyed. So they are built once, not once each. What can't be built so (constants, functions whose type has no
name) is left to cargo-mutants.
"""

import json
import os
import re
import resource
import signal
import subprocess
import time
from collections import defaultdict
from pathlib import Path

WHICH = "MUTANT"
TRACE = "MUTANT_TRACE"
# A mutant may ask for a lot of memory; the machine must not go down with it.
MEMORY_BYTES = 8 << 30

SWITCH = """
#[doc(hidden)]
#[allow(missing_docs)]
pub mod mutated {
    extern crate std;
    use std::io::Write;
    use std::string::String;
    use std::sync::{Mutex, OnceLock};
    use std::vec::Vec;
    static SETTING: OnceLock<(u32, Option<String>)> = OnceLock::new();
    static SEEN: Mutex<Vec<u32>> = Mutex::new(Vec::new());
    pub fn which(function: u32) -> u32 {
        let setting = || (std::env::var("MUTANT").ok().and_then(|text| text.parse().ok()).unwrap_or(0), std::env::var("MUTANT_TRACE").ok());
        let (which, trace) = SETTING.get_or_init(setting);
        if let Some(path) = trace {
            let mut seen = SEEN.lock().unwrap_or_else(|broken| broken.into_inner());
            if !seen.contains(&function) {
                seen.push(function);
                let file = std::fs::OpenOptions::new().append(true).create(true).open(path);
                let _ = file.and_then(|mut file| file.write_all(std::format!("{function}\\n").as_bytes()));
            }
        }
        *which
    }
}
"""


class Program:
    """A copy of the repository in which a crate carries the mutants."""

    def __init__(self, tree, build, crate, mutants):
        self.tree, self.build, self.crate = tree, build, crate
        self.mutants = {number: mutant for number, mutant in enumerate(mutants, 1)}
        # Alone: not possible here, so for cargo-mutants. Unviable: no program at all.
        self.alone, self.unviable = set(), set()
        self.sources = {file: (tree / file).read_text() for file in {mutant["file"] for mutant in mutants}}
        root = next(tree / crate / "src" / name for name in ("lib.rs", "main.rs") if (tree / crate / "src" / name).exists())
        root_file = str(root.relative_to(tree))
        self.sources.setdefault(root_file, root.read_text())
        self.root_file = root_file
        self.functions = self._functions()

    def _functions(self):
        """Of each function its file, where its body begins and ends, whether it is const, and its mutants."""
        spans = defaultdict(set)
        for number, mutant in self.mutants.items():
            if mutant["function"] is None:
                self.alone.add(number)
                continue
            spans[mutant["file"]].add(self._range(mutant["file"], mutant["function"]["span"]) + (mutant["function"]["function_name"],))
        found = []
        for file, all_spans in spans.items():
            outer = [one for one in all_spans if not any(o[0] <= one[0] and one[1] <= o[1] and o[:2] != one[:2] for o in all_spans)]
            for begin, end, name in sorted(outer):
                inside = [
                    number
                    for number, mutant in self.mutants.items()
                    if mutant["file"] == file and number not in self.alone and begin <= self._range(file, mutant["span"])[0] < end
                ]
                found.append(Function(file, name, begin, end, self.sources[file], inside))
        for function in found:
            if function.body is None:
                self.alone |= set(function.mutants)
        return [function for function in found if function.body is not None]

    def _range(self, file, span):
        starts = line_starts(self.sources[file])
        return tuple(starts[span[at]["line"] - 1] + span[at]["column"] - 1 for at in ("start", "end"))

    def write(self):
        """Writes the sources; which line belongs to which mutant."""
        owners = {}
        for file, source in self.sources.items():
            written, at, line = [], 0, 1
            owner = {}

            def put(text, number=None, function=None):
                nonlocal line
                count = text.count("\n")
                for one in range(line, line + count + 1):
                    if number is not None:
                        owner[one] = number
                    elif function is not None:
                        owner.setdefault(one, function)
                line += count
                written.append(text)

            for index, function in enumerate(self.functions, 1):
                if function.file != file:
                    continue
                numbers = [number for number in function.mutants if number not in self.alone and number not in self.unviable]
                if not numbers:
                    continue
                begin, end = function.body
                head = source[function.begin : begin]
                put(source[at : function.begin])
                put(re.sub(r"\bconst(\s+(?:async\s+)?fn\b)", r"\1", head) if function.is_const else head, function=function)
                put(f"\n match crate::mutated::which({index}) {{\n", function=function)
                for number in numbers:
                    first, last = self._range(file, self.mutants[number]["span"])
                    put(f"{number} => {{\n")
                    put(source[begin:first] + self.mutants[number]["replacement"] + source[last:end] + "\n", number)
                    put("}\n")
                put("_ => {\n")
                put(source[begin:end])
                put("\n} } ", function=function)
                at = end
            put(source[at:])
            text = "".join(written) + (SWITCH if file == self.root_file else "")
            if (self.tree / file).read_text() != text:
                (self.tree / file).write_text(text)
            owners[file] = owner
        return owners

    def check(self):
        """Leaves out what does not compile, until the rest does; False if that can't be done."""
        for _ in range(30):
            owners = self.write()
            errors = self._errors()
            if not errors:
                return True
            known = False
            for message in errors:
                known |= self._leave_out(message, owners)
            if not known:
                print("\n".join(message.get("rendered") or message["message"] for message in errors[:5]))
                return False
        return False

    def _errors(self):
        target = ["--bins"] if self.root_file.endswith("main.rs") else ["--lib"]
        command = ["cargo", "check", "--locked", "--profile", "mutants", "--package", self.crate, *target, "--message-format", "json"]
        done = subprocess.run(command, cwd=self.tree, env=self.build, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        if done.returncode == 0:
            return []
        messages = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
        errors = [message["message"] for message in messages if message.get("reason") == "compiler-message"]
        return [error for error in errors if error["level"] == "error" and error["spans"]]

    def _leave_out(self, message, owners):
        spans = sorted(message["spans"], key=lambda span: not span["is_primary"])
        whose = [owners.get(span["file_name"], {}).get(span["line_start"]) for span in spans]
        number = next((one for one in whose if isinstance(one, int)), None)
        # A function that a constant needs keeps its own body.
        asked = re.search(r"non-const \w+(?: function)? `(?:.*::)?(\w+)(?:::<.*>)?`", message["message"])
        if asked:
            named = {number for one in self.functions if one.is_const and one.name == asked[1] for number in one.mutants}
            more = named - self.alone
            self.alone |= named
            return bool(more)
        if number is not None:
            function = next(one for one in self.functions if number in one.mutants)
            (self.alone if function.is_opaque else self.unviable).update(function.mutants if function.is_opaque else [number])
            return True
        function = next((one for one in whose if isinstance(one, Function)), None)
        if function is None:
            return False
        more = set(function.mutants) - self.alone - self.unviable
        self.alone |= more
        return bool(more)

    def in_it(self):
        """The mutants that this program carries, and of each the function."""
        carried = {}
        for index, function in enumerate(self.functions, 1):
            for number in function.mutants:
                if number not in self.alone and number not in self.unviable:
                    carried[number] = index
        return carried


class Function:
    """A function, as it stands in its file."""

    def __init__(self, file, name, begin, end, source, mutants):
        self.file, self.begin, self.end, self.mutants = file, begin, end, mutants
        self.name = re.sub(r"^.*::", "", name)
        head = re.compile(r"^[ \t]*(?:pub(?:\([^)]*\))?\s+)?(const\s+)?(?:async\s+)?fn\s+" + re.escape(self.name) + r"\b", re.M)
        found = head.search(source, source.rfind("\n", 0, begin) + 1, end)
        self.body = found and self._body(source, found.end())
        self.is_const = bool(found and found[1])
        self.is_opaque = bool(self.body and "impl " in source[found.end() : self.body[0]].partition("->")[2])

    def _body(self, source, at):
        depth = 0
        for here in range(at, self.end):
            depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(source[here], 0)
            if source[here] == "{" and depth == 0:
                return here + 1, self.end - 1
        return None


def line_starts(source):
    starts = [0]
    for line in source.split("\n"):
        starts.append(starts[-1] + len(line) + 1)
    return starts


class Tests:
    """The tests of a pass, and which functions each of them comes to."""

    def __init__(self, tree, build, look, folder):
        self.tree, self.build, self.folder = tree, build, folder
        self.folder.mkdir(parents=True, exist_ok=True)
        self.tests = []
        for executable, package, names in self._built(look):
            wanted = [name for name in names if look.wants(name)]
            self.tests += [(executable, package, name) for name in wanted]
        self.seconds, self.touched = {}, {}

    def _built(self, look):
        command = ["cargo", "test", "--locked", "--profile", "mutants", "--package", look.package, *look.features, *look.targets]
        command += ["--no-run", "--message-format", "json"]
        done = subprocess.run(command, cwd=self.tree, env={**self.build, **look.profile()}, stdout=subprocess.PIPE, text=True, check=True)
        artifacts = [json.loads(line) for line in done.stdout.splitlines() if '"executable"' in line]
        artifacts = [one for one in artifacts if one.get("executable")]
        for one in artifacts:
            if "bin" in one["target"]["kind"] and not one["profile"]["test"]:
                self.build[f"CARGO_BIN_EXE_{one['target']['name']}"] = one["executable"]
        for one in artifacts:
            if one["profile"]["test"]:
                package = Path(one["manifest_path"]).parent
                listed = subprocess.run([one["executable"], "--list", "--format", "terse"], cwd=package, env=self.build, capture_output=True, text=True)
                yield one["executable"], package, [line.removesuffix(": test") for line in listed.stdout.splitlines() if line.endswith(": test")]

    def trace(self):
        """Runs each test once without a mutant; those that fail so, alone and traced."""
        failed = []
        for index, test in enumerate(self.tests):
            file = self.folder / f"{index}.trace"
            file.unlink(missing_ok=True)
            begun = time.monotonic()
            if not self._passes(test, {TRACE: str(file)}, 900):
                failed.append(test[2])
            self.seconds[test] = time.monotonic() - begun
            self.touched[test] = set(map(int, file.read_text().split())) if file.exists() else set()
        return failed

    def who_notices(self, number, function, least_s, patience):
        """(status, test) of a mutant: the quickest tests first."""
        for test in sorted((one for one in self.tests if function in self.touched[one]), key=self.seconds.get):
            outcome = self._passes(test, {WHICH: str(number)}, max(least_s, patience * self.seconds[test]))
            if outcome is not True:
                return ("timeout" if outcome is None else "caught"), test[2]
        return "missed", None

    def _passes(self, test, environment, timeout_s):
        """Whether a test passes; None if it never ends."""
        executable, package, name = test
        process = subprocess.Popen(
            [executable, "--exact", name],
            cwd=package,
            env={**self.build, "CARGO_MANIFEST_DIR": str(package), **environment},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES)),
        )
        try:
            return process.wait(timeout_s) == 0
        except subprocess.TimeoutExpired:
            return None
        finally:
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            process.wait()
