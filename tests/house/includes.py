#!/usr/bin/env python3
"""includes.py FILE...: each source includes, itself or through palpa's own headers, what the names it uses come from, other
people's and palpa's own; and the headers that its comments name exist. The compiler misses nothing that the build parses once for all (cmake/Library.cmake) or that another source
of a unit has included (cmake/Units.cmake).
"""
import functools
import itertools
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Header: the names that show a use of it. If several headers have one name, any of them is enough.
NAMES = {
    "algorithm": "sort stable_sort find find_if find_if_not any_of all_of none_of count count_if copy copy_n copy_if fill fill_n "
                 "transform max_element min_element minmax_element clamp lower_bound upper_bound equal_range binary_search reverse "
                 "rotate unique nth_element partial_sort next_permutation shuffle generate remove_if replace equal mismatch search "
                 "is_sorted adjacent_find partition stable_partition for_each set_union set_difference includes merge",
    "array": "array to_array", "atomic": "atomic atomic_flag atomic_ref memory_order_relaxed memory_order_acquire",
    "chrono": "chrono", "complex": "complex", "filesystem": "filesystem", "fstream": "ifstream ofstream fstream",
    "functional": "function bind invoke greater", "future": "async future promise", "iomanip": "setprecision setw setfill",
    "limits": "numeric_limits", "map": "map multimap", "memory": "unique_ptr shared_ptr make_unique make_shared",
    "mutex": "mutex lock_guard unique_lock scoped_lock once_flag call_once", "condition_variable": "condition_variable",
    "numbers": "numbers", "numeric": "accumulate iota reduce inner_product partial_sum gcd lcm exclusive_scan midpoint",
    "optional": "optional nullopt", "queue": "queue priority_queue", "deque": "deque", "list": "list", "set": "set multiset",
    "random": "mt19937 mt19937_64 uniform_real_distribution uniform_int_distribution normal_distribution bernoulli_distribution",
    "span": "span as_bytes", "sstream": "stringstream ostringstream istringstream", "string_view": "string_view",
    "string": "string to_string stoi stod getline", "thread": "thread jthread this_thread", "tuple": "tuple tie make_tuple",
    "unordered_map": "unordered_map", "unordered_set": "unordered_set", "variant": "variant visit monostate holds_alternative",
    "vector": "vector", "bit": "bit_cast popcount countl_zero countr_zero bit_ceil bit_width has_single_bit", "regex": "regex",
    "iterator": "istreambuf_iterator back_inserter istream_iterator ostream_iterator",
    "cmath": "sqrt abs sin cos tan atan2 asin acos atan floor ceil round lround hypot pow exp log fmod isfinite isnan isinf fabs "
             "copysign nextafter ldexp frexp remainder cbrt lerp log2 log10 trunc nearbyint",
    "cstring": "memcpy memset memcmp memmove strlen strerror strcmp strncmp",
    "charconv": "from_chars to_chars", "cctype": "isdigit isalpha isalnum isspace toupper", "cstdlib": "getenv exit abort",
    "exception": "exception_ptr current_exception rethrow_exception", "compare": "strong_ordering",
    "cstdint": "uint8_t uint16_t uint32_t uint64_t int8_t int16_t int32_t int64_t uintptr_t",
}
OTHERS = [  # pattern, headers of which one must be included
    (r"\bfmt::(?!runtime|format_to_n|memory_buffer|join)\w", r"fmt/"),
    (r"\bfmt::(memory_buffer|join)\b", r"fmt/(format|ranges)\.h"),
    (r"\bglm::\w", r"glm/"),
    (r"\bnlohmann::\w", r"nlohmann/"),
    (r"\b(Vk[A-Z]|vk[A-Z]|VK_)\w", r"volk\.h|vulkan/"),
    (r"\bCLI::(?!App\b)\w", r"CLI/"),
    (r"\bIm(Gui::|Vec[24]\b|DrawList\b)", r"imgui"),
    (r"\b(glfw|GLFW)\w", r"GLFW/"),
    (r"\blibusb_\w", r"libusb\.h"),
    (r"\berrno\b", r"cerrno|errno\.h"),
    (r"(?<!\w)::(read|write|close|unlink|getpid|isatty|pipe2?|fsync|dup2?|fork|_exit|lseek|ftruncate|geteuid)\(|"
     r"\bSTD(IN|OUT|ERR)_FILENO\b|\bisatty\(", r"unistd\.h"),
    (r"\bO_(RDONLY|WRONLY|RDWR|CREAT|NONBLOCK|CLOEXEC|TRUNC|EXCL)\b", r"fcntl\.h"),
    (r"\b(pollfd|POLLIN|POLLOUT|POLLHUP)\b", r"poll\.h"),
    (r"(?<!\w)::(socket|connect|accept4?|bind|listen|send|recv|sendmsg|recvmsg|shutdown|setsockopt)\(|"
     r"\bSOCK_\w|\bMSG_(NOSIGNAL|DONTWAIT)\b", r"sys/socket\.h"),
    (r"\b(mmap|munmap)\(|\bMAP_(FAILED|SHARED|PRIVATE)\b", r"sys/mman\.h"),
    (r"(?<!\w)::(f?stat|f?chmod|mkdir|mkfifo|umask)\(|\bS_IS[A-Z]+\(", r"sys/stat\.h"),
    (r"(?<!\w)::ioctl\(", r"sys/ioctl\.h"),
    (r"\b(SIGINT|SIGTERM|SIGHUP|SIGKILL|SIGPIPE|sigaction|sigset_t)\b", r"csignal|signal\.h"),
    (r"\b(TEST|TEST_F|TEST_P|EXPECT_\w+|ASSERT_\w+)\s*\(", r"gtest/"),
]
# Headers that always provide another header's names.
ENOUGH = {"cmath": {"complex"}, "cstdint": {"volk.h"}, "iterator": {"fstream", "sstream", "iostream"},
          "string": {"fstream", "sstream", "filesystem"}, "string_view": {"string"}}


def plain(text):
    """The text without comments, strings and characters."""
    return re.sub(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'',
                  lambda found: '""' if found[0][-1] == '"' else " ", text, flags=re.S)


@functools.cache
def read(path):
    return path.read_text()


# The names that one of palpa's headers declares at the beginning of a line, for use elsewhere: types, functions,
# constants, macros.
TYPE = r"(?:template\s*<[^;{]*>\s*)?(?:struct|class|enum class|enum|union)\s+(\w+)\s*(?:final\s*)?[:{]"
DECLARED = re.compile(r"^(?:" + TYPE + r"|using (\w+) =|(?! )(?:\[\[\w+\]\] |[\w:<>,*& ])*?[\w>*&] [*&]*(\w+)\(|"
                      r"(?:inline |static |constexpr |const )+[\w:<>,*& ]+?(\w+)(?:\[\w*\])*(?: = |\{|;)|#define (\w+))", re.M)
# A type, or a function that is called and is not a member; or a name in one of palpa's namespaces, if it is qualified.
USED = re.compile(r"(?:\b([a-z]\w*)::|(?<![\w.>~:]))(?:([A-Z]\w*[a-z]\w*)\b|(\w+)\()")
SPACE = re.compile(r"^namespace ([\w:]+) \{", re.M)
SYSTEM = {"open", "read", "write", "close", "poll", "extent"}  # also names of the kernel and the language
NO_TYPES = set("return else case throw new delete not and or co_return const constexpr static inline virtual explicit mutable "
               "public private".split())


@functools.cache
def words(path):
    return frozenset(re.findall(r"\w+", plain(read(path))))


@functools.cache
def homes():
    """Name: palpa's headers that declare it; and palpa's namespaces."""
    found, spaces = {}, {""}
    for folder in ("engine", "driver", "viewer", "assets", "tests"):
        for header in (ROOT / folder).rglob("*.hpp"):
            text = plain(read(header))
            spaces.update(*(names.split("::") for names in SPACE.findall(text)))
            for names in DECLARED.findall(text):
                for name in set(names) - SYSTEM - {""}:
                    found.setdefault(name, set()).add(header)
    return found, spaces


def its_own(name, text):
    """Whether the text declares something of that name: a word that may be a type stands before it."""
    before = re.findall(r"([\w>\]]+)[&*]*\s+[&*]*" + name + r"\b(?!\s*<)", text)
    return any(word not in NO_TYPES for word in before) or re.search(r"[&,[] *" + name + " = ", text)


def missing_own(path, text, headers):
    if path.suffix != ".cpp":
        return
    known, spaces = homes()
    text = re.sub(r"\b(?:INSTANTIATE_)?TEST\w*\(\w*, *\w+|\btesting::\w+", "", text)  # a test's names are not uses
    there = frozenset().union(*(words(header) for header in headers))
    for space, type_name, function in set(USED.findall(text)):
        name = type_name or function
        if space in spaces and name in known and name not in there and not its_own(name, text):
            yield f"{name} comes from {' or '.join(sorted(str(header.relative_to(ROOT)) for header in known[name]))}"


def resolve(name, beside):
    for folder in (beside.parent, ROOT, ROOT / "engine", ROOT / "tests", ROOT / "python"):
        if (folder / name).is_file():
            return folder / name
    return None


@functools.cache
def included(path):
    """The headers of other people's, by name, and palpa's own that this file itself includes."""
    names = re.findall(r'^\s*#\s*include\s*([<"])([^>"]+)', read(path), flags=re.M)
    found = {name: resolve(name, path) if kind == '"' else None for kind, name in names}
    return {name for name, own in found.items() if own is None}, {own for own in found.values() if own}


def reached(path):
    """The headers of other people's, by name, and palpa's own that this file includes, itself or through palpa's own."""
    seen, found, todo = {path}, set(), {path}
    while todo:
        others, own = included(todo.pop())
        found |= others
        todo |= own - seen
        seen |= own
    return found, seen - {path}


def missing(path):
    text, (headers, own) = plain(read(path)), reached(path)
    yield from missing_own(path, text, own)
    used = set(re.findall(r"\bstd::(?:ranges::)?(\w+)", text))
    for header, names in NAMES.items():
        hits = sorted(used.intersection(names.split()))
        if hits and header not in headers and not ENOUGH.get(header, set()) & headers:
            yield f"std::{hits[0]} comes from <{header}>"
    for pattern, header in OTHERS:
        use = re.search(pattern, text)
        if use and not any(re.match(header, name) for name in headers):
            yield f"{use[0]} comes from a header that is not included"


@functools.cache
def own_headers():
    """The paths of palpa's own headers below ROOT, each with a slash in front."""
    return [f"/{header.relative_to(ROOT)}" for folder in ("engine", "driver", "viewer", "assets", "python", "shaders", "tests")
            for suffix in ("*.hpp", "*.h") for header in (ROOT / folder).rglob(suffix)]


def named_but_gone(path):
    for comment in re.findall(r"//(.*)", read(path)):
        for name in re.findall(r"(?<![\w./-])(?:\w+/)*\w+\.hpp\b", comment):
            if not any(header.endswith("/" + name) for header in own_headers()):
                yield f"a comment names {name}, which does not exist"


def main():
    found = 0
    for name in sys.argv[1:]:
        for what in itertools.chain(missing(ROOT / name), named_but_gone(ROOT / name)):
            print(f"   {name}: {what}")
            found += 1
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
