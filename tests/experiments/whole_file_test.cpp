// SPDX-License-Identifier: GPL-3.0-or-later
#include <csignal>
#include <fstream>
#include <thread>

#include <catch2/catch.hpp>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "cinch/surface.hpp"
#include "experiments/report/line_file.hpp"
#include "experiments/report/whole_file.hpp"
#include "tests/support.hpp"
#include "toolkit/surface/checksum.hpp"
#include "toolkit/surface/read_mesh.hpp"

using namespace cinch;
namespace fs = std::filesystem;

namespace {

std::vector<std::string> names_in(const fs::path& folder)
{
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder))
        names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

mode_t mode_of(const fs::path& file)
{
    struct stat is = {};
    REQUIRE(stat(file.c_str(), &is) == 0);
    return is.st_mode & 07777;
}

std::string complaint(const std::function<void()>& call)
{
    try {
        call();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no complaint";
}

using Names = std::vector<std::string>;

} // namespace

TEST_CASE("an output appears when it is whole, and what stood there stays until then")
{
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "out";
    for (const bool exists : {false, true}) {
        if (exists)
            folder.write("out", "old");
        const Names before = names_in(folder.path());
        {
            WholeFile given_up(file);
            given_up.write(std::string(300000, 'x'));
            CHECK(names_in(folder.path()).size() == before.size() + 1); // beside it
            CHECK((!exists || read_bytes(file) == "old"));
        }
        CHECK(names_in(folder.path()) == before);
        CHECK((!exists || read_bytes(file) == "old"));
        WholeFile whole(file);
        whole.write("new, ");
        whole.write(std::string(300000, 'y'));
        CHECK((!exists || read_bytes(file) == "old"));
        whole.commit();
        CHECK(read_bytes(file) == "new, " + std::string(300000, 'y'));
        CHECK(names_in(folder.path()) == Names{"out"});
        fs::remove(file);
    }
}

TEST_CASE("an output has the mode of every new file, or that of the file it replaces")
{
    const test::TemporaryFolder folder;
    const mode_t before = umask(027);
    write_whole(folder.path() / "fresh", "x");
    umask(before);
    CHECK(mode_of(folder.path() / "fresh") == 0640);
    folder.write("there", "old");
    REQUIRE(chmod((folder.path() / "there").c_str(), 0604) == 0);
    write_whole(folder.path() / "there", "x");
    CHECK(mode_of(folder.path() / "there") == 0604);
}

TEST_CASE("the target of a link is replaced, not the link")
{
    const test::TemporaryFolder folder;
    fs::create_directory(folder.path() / "far");
    folder.write("far/target", "old");
    fs::create_symlink("far/target", folder.path() / "one");
    fs::create_symlink(folder.path() / "one", folder.path() / "two");
    fs::create_symlink("far/none", folder.path() / "dangling");
    write_whole(folder.path() / "two", "new");
    write_whole(folder.path() / "dangling", "made");
    CHECK(fs::is_symlink(folder.path() / "two"));
    CHECK(fs::is_symlink(folder.path() / "one"));
    CHECK(fs::is_symlink(folder.path() / "dangling"));
    CHECK(read_bytes(folder.path() / "far/target") == "new");
    CHECK(read_bytes(folder.path() / "far/none") == "made");
    CHECK(names_in(folder.path() / "far") == Names{"none", "target"});
    fs::create_symlink("loop", folder.path() / "loop");
    CHECK_THAT(complaint([&] { WholeFile file(folder.path() / "loop"); }), Catch::Contains("cannot be written"));
}

TEST_CASE("what is no regular file is written directly, and stays what it is")
{
    const test::TemporaryFolder folder;
    const fs::path pipe = folder.path() / "pipe";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    std::string read;
    std::thread reader([&] {
        std::ifstream in(pipe);
        read.assign(std::istreambuf_iterator<char>(in), {});
    });
    write_whole(pipe, "through");
    reader.join();
    CHECK(read == "through");
    CHECK(fs::is_fifo(pipe));
    write_whole("/dev/null", "nothing");
    CHECK(fs::is_character_file("/dev/null"));
    CHECK(complaint([] { write_whole("/dev/full", "x"); }) ==
          "/dev/full: cannot be written: No space left on device; the disk is full");
    CHECK_THAT(complaint([&] { WholeFile file(folder.path()); }), Catch::EndsWith("cannot be written: it is a folder"));
    CHECK_THAT(complaint([&] { WholeFile file(folder.path() / "none/out"); }),
               Catch::Contains("none/out: cannot be written: No such file or directory"));
}

TEST_CASE("no output takes the place of an input, by whatever name, and no two outputs are one file")
{
    const test::TemporaryFolder folder;
    const fs::path input = folder.write("input.obj", "v 0 0 0\n");
    fs::create_symlink("input.obj", folder.path() / "link");
    fs::create_hard_link(input, folder.path() / "hard");
    fs::create_directory(folder.path() / "sub");
    const Names before = names_in(folder.path());
    { // an output that is open when the input is named
        const WholeFile early(folder.path() / "hard");
        CHECK_THAT(complaint([&] { guard_input(folder.path() / "link"); }),
                   Catch::Contains("is an input of this command"));
    }
    guard_input(folder.path() / "link");
    for (const char* name : {"input.obj", "link", "hard", "sub/../input.obj"}) {
        CAPTURE(name);
        CHECK_THAT(complaint([&] { WholeFile file(folder.path() / name); }),
                   Catch::Contains("is an input of this command"));
        CHECK_THAT(complaint([&] { WholeFile::continued(folder.path() / name); }),
                   Catch::Contains("is an input of this command"));
    }
    CHECK(names_in(folder.path()) == before);
    CHECK(read_bytes(input) == "v 0 0 0\n");

    const fs::path a = folder.path() / "a";
    WholeFile first(a);
    for (const fs::path& same : {a, folder.path() / "sub/../a"})
        CHECK_THAT(complaint([&] { WholeFile second(same); }), Catch::Contains("is named for two outputs"));
    first.commit();
    write_whole(a, "again"); // one after the other is fine
    CHECK(names_in(folder.path()).size() == before.size() + 1);
}

TEST_CASE("a file that cannot grow leaves what was there, and nothing beside it")
{
    const test::TemporaryFolder folder;
    const fs::path file = folder.write("out", "old");
    struct rlimit limit = {};
    REQUIRE(getrlimit(RLIMIT_FSIZE, &limit) == 0);
    const auto before = signal(SIGXFSZ, SIG_IGN);
    struct rlimit small = limit;
    small.rlim_cur = 100000;
    REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
    const std::string plain = complaint([&] { write_whole(file, std::string(200000, 'x')); });
    const std::string packed = complaint([&] {
        LineFile out((folder.path() / "out.gz").string());
        for (std::uint64_t i = 1; i < 1000000; ++i) // which does not compress
            out.line(std::to_string(i * 0x9e3779b97f4a7c15u));
        out.commit();
    });
    setrlimit(RLIMIT_FSIZE, &limit);
    signal(SIGXFSZ, before);
    CHECK_THAT(plain, Catch::EndsWith("out: cannot be written: File too large"));
    CHECK_THAT(packed, Catch::EndsWith("out.gz: cannot be written: File too large"));
    CHECK(read_bytes(file) == "old");
    CHECK(names_in(folder.path()) == Names{"out"});
}

TEST_CASE("lines come out of a compressed file as they went in")
{
    const test::TemporaryFolder folder;
    for (const char* name : {"lines", "lines.gz"}) {
        const std::string file = (folder.path() / name).string();
        std::string expected;
        LineFile out(file);
        for (int i = 0; i < 50000; ++i) {
            const std::string line = std::string(static_cast<std::size_t>(i % 7), 'l') + std::to_string(i);
            out.line(line);
            expected += line + "\n";
        }
        CHECK_FALSE(fs::exists(file));
        out.commit();
        const gzFile in = gzopen(file.c_str(), "rb");
        std::string read(expected.size() + 1, '\0');
        read.resize(static_cast<std::size_t>(std::max(0, gzread(in, read.data(), static_cast<unsigned>(read.size())))));
        gzclose(in);
        CHECK(read == expected);
    }
}

TEST_CASE("a run that stops leaves its part, and another goes on in it")
{
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "frames", part = folder.path() / "frames.part";
    {
        WholeFile first = WholeFile::continued(file);
        first.write("0123456789");
        first.sync();
        CHECK(first.part() == fs::canonical(part).string());
        CHECK_THAT(complaint([&] { WholeFile::continued(file); }), Catch::Contains("frames: is named for two outputs"));
    }
    CHECK(names_in(folder.path()) == Names{"frames.part"});
    CHECK_THAT(complaint([&] { WholeFile::continued(file, 5, checksum("01235")); }),
               Catch::Contains("does not have the 5 bytes"));
    CHECK_THAT(complaint([&] { WholeFile::continued(file, 11, checksum("0123456789x")); }),
               Catch::Contains("does not have the 11 bytes"));
    CHECK(read_bytes(part) == "0123456789");
    {
        WholeFile second = WholeFile::continued(file, 5, checksum("01234"));
        second.write("abc");
        second.commit();
    }
    CHECK(names_in(folder.path()) == Names{"frames"});
    CHECK(read_bytes(file) == "01234abc");
    { // longer than what was whole, which stays until then
        WholeFile third = WholeFile::continued(file, 7, checksum("01234ab"));
        third.write("!");
        third.sync();
        CHECK(read_bytes(file) == "01234abc");
        CHECK(read_bytes(part) == "01234ab!");
        third.commit();
    }
    CHECK(read_bytes(file) == "01234ab!");
    { // nothing written, nothing left
        const WholeFile none = WholeFile::continued(folder.path() / "none");
    }
    CHECK(names_in(folder.path()) == Names{"frames"});
}
