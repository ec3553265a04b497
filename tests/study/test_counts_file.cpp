// Tables of counts as CSV.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "study/files/counts_file.hpp"
#include "support/thrown.hpp"

namespace palpa::study {
namespace {

TEST(CountsFile, HasTheCountsOfEachShape) {
  const CountsFile file = parse_counts("actual,cube,prism\ncube,50,30\nprism,9,11\n", "a.csv");
  EXPECT_EQ(file.table.shapes, (std::vector<std::string>{"cube", "prism"}));
  EXPECT_EQ(file.table.counts, (std::vector<std::uint64_t>{50, 30, 9, 11}));
  EXPECT_TRUE(file.warnings.empty());
}

TEST(CountsFile, RowsMayBeInAnyOrderAndOfASpreadsheet) {
  const Confusion table = parse_counts("\xef\xbb\xbf;\"cube\";prism\r\nprism;3; 4\r\ncube;1;2\r\n", "a.csv").table;
  EXPECT_EQ(table.shapes, (std::vector<std::string>{"cube", "prism"}));
  EXPECT_EQ(table.counts, (std::vector<std::uint64_t>{1, 2, 3, 4}));
  EXPECT_EQ(parse_counts("x\ta\tb\na\t1\t0\nb\t0\t1\n", "a.tsv").table.correct(), 2u);
}

TEST(CountsFile, AQuotedNameMayHaveASeparator) {
  const Confusion table =
      parse_counts("x,\"cube, small\",prism\n \"cube, small\" ,1,\"2\"\nprism,3,4\n", "a.csv").table;
  EXPECT_EQ(table.shapes, (std::vector<std::string>{"cube, small", "prism"}));
  EXPECT_EQ(table.counts, (std::vector<std::uint64_t>{1, 2, 3, 4}));
}

TEST(CountsFile, AFaultIsOneLineWithItsPlace) {
  const std::vector<std::pair<std::string, std::string>> faults{
      {"x,a,b\na,1,-2\nb,0,1\n", "a.csv: line 2: '-2' is not a count: give whole numbers of answers"},
      {"x,a,b\na,1,2\nb,nan,1\n", "line 3: 'nan' is not a count"},
      {"x,a,b\na,0.5,0.5\nb,0,1\n", "line 2: '0.5' is not a count"},
      {"x,a,b\na,1,99999999999999999999\nb,0,1\n", "is not a count"},
      {"x,a,b\na,1\nb,0,1\n", "line 2: 1 count where line 1 has 2 answers"},
      {"x,a,b\na,1,2,3\nb,0,1\n", "line 2: 3 counts where line 1 has 2 answers"},
      {"x,a,b\na,1,2\ncone,0,1\n", "line 3: the shape 'cone' is not among the answers a, b"},
      {"x,a,b\na,1,2\na,0,1\n", "line 3: shape 'a' already has a line"},
      {"x,a,b\na,1,2\n", "has no line of the shape 'b'"},
      {"x,a,b\na,0,0\nb,0,0\n", "all counts are 0"},
      {"x,a,a\na,1,2\n", "line 1: name 2 is there twice"},
      {"x,,a\na,1,2\n", "line 1: name 1 is not a name of 1 to 64 letters"},
      {"x,a\na,1\n", "line 1: has 1 shapes, 2 to 64 are needed"},
      {"", "line 1: has 0 shapes"},
      {"50 30 9 11\n", "line 1: has 0 shapes"}};
  for (const auto& fault : faults)
    EXPECT_REFUSED(parse_counts(fault.first, "a.csv"), fault.second);
}

TEST(CountsFile, ALastLineWithoutEndIsReported) {
  const CountsFile file = parse_counts("x,a,b\na,1,2\nb,0,1", "a.csv");
  EXPECT_EQ(file.table.total(), 4u);
  EXPECT_EQ(file.warnings, std::vector<std::string>{"a.csv: line 3 has no end: check that the file is complete"});
  EXPECT_EQ(parse_counts("x,W\xfcrfel,b\nW\xfcrfel,1,2\nb,3,4\n", "a.csv").warnings,
            std::vector<std::string>{"a.csv: line 1 has bytes that are not UTF-8: save the table as UTF-8"});
  EXPECT_TRUE(parse_counts("x,W\xc3\xbcrfel,b\nW\xc3\xbcrfel,1,2\nb,3,4\n", "a.csv").warnings.empty());
}

TEST(CountsFile, SumsAreNamedAndLeftOut) {
  const std::vector<std::uint64_t> counts{50, 15, 28, 37};
  const std::string column = "a.csv: the answer 'Total' is the sum of the others and left out",
                    row = "a.csv: line 4: 'Total' is the sum of the other lines and left out";
  const auto expect = [&](const std::string& text, const std::vector<std::string>& warnings) {
    const CountsFile file = parse_counts(text, "a.csv");
    EXPECT_EQ(file.table.shapes, (std::vector<std::string>{"cube", "pyramid"})) << text;
    EXPECT_EQ(file.table.counts, counts) << text;
    EXPECT_EQ(file.warnings, warnings) << text;
  };
  expect("x,cube,pyramid,Total\ncube,50,15,65\npyramid,28,37,65\nTotal,78,52,130\n", {column, row});
  expect("x,cube,pyramid,Total\ncube,50,15,65\npyramid,28,37,65\n", {column});
  expect("x,cube,pyramid\ncube,50,15\npyramid,28,37\nTotal,78,52\n", {row});
  expect("x,All,cube,pyramid\nAll,130,78,52\ncube,65,50,15\npyramid,65,28,37\n",
         {"a.csv: the answer 'All' is the sum of the others and left out",
          "a.csv: line 2: 'All' is the sum of the other lines and left out"});
  // Shapes, however they are called and whatever else adds up.
  for (const std::string text : {"x,a,b\na,3,3\nb,3,3\n", "x,a,b,c\na,1,1,2\nb,1,1,2\nc,0,2,2\n",
                                 "x,a,Sum\na,1,2\nSum,3,4\n", "x,a,b,c\na,0,0,0\nb,0,0,0\nc,0,1,0\n"}) {
    EXPECT_TRUE(parse_counts(text, "a.csv").warnings.empty()) << text;
  }
  EXPECT_REFUSED(parse_counts("x,cube,pyramid,Total\ncube,50,15,65\npyramid,28,37,66\n", "a.csv"),
                 "has no line of the shape 'Total'");
  EXPECT_REFUSED(parse_counts("x,cube,pyramid\ncube,50,15\npyramid,28,37\nTotal,78,53\n", "a.csv"),
                 "the shape 'Total' is not among the answers cube, pyramid");
}

TEST(CountsFile, ReadsWhatSpreadsheetsAdd) {
  const std::vector<std::uint64_t> counts{50, 15, 28, 37};
  for (const std::string text :
       {"sep=;\nx;cube;pyramid\ncube;50;15\npyramid;28;37\n", "\"sep=|\"\nx|cube|pyramid\ncube|50|15\npyramid|28|37\n",
        "x,cube,pyramid,\ncube,50,15,\npyramid,28,37,\n", "x,cube,pyramid,,\ncube,50,15\npyramid,28,37,\n,,\n"}) {
    EXPECT_EQ(parse_counts(text, "a.csv").table.counts, counts) << text;
  }
  EXPECT_REFUSED(parse_counts("x,a,b\na,1,\nb,1,2\n", "a.csv"), "line 2: 1 count where line 1 has 2 answers");
}

}  // namespace
}  // namespace palpa::study
