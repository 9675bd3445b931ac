// SPDX-License-Identifier: BSD-3-Clause
// Text that goes into a page: escapes, numbers, base64, tables of documents good and odd.
#include "../page.hpp"
#include "../facts.hpp"
#include "view.hpp"

#include "check.h"

#include <limits>

using namespace conceg;
using namespace conceg::reporting;

static std::string array_of(double value) {
  return Json().open('[').number(value).close(']').str();
}

static bool contains(const std::string &text, const std::string &part) {
  return text.find(part) != std::string::npos;
}

// Nothing of a name may end the <script> that it stands in.
static void escapes() {
  const std::string json = Json().open('[').text("</script><!-- \"a\" \\ b & \n\t\x01 µm").close(']').str();
  CHECK_TEXT(json.c_str(),
             "[\"\\u003c/script\\u003e\\u003c!-- \\\"a\\\" \\\\ b \\u0026 \\u000a\\u0009\\u0001 µm\"]");
  for (const char c : {'<', '>', '&'})
    CHECK(json.find(c) == std::string::npos);
}

static void numbers() {
  CHECK_TEXT(array_of(0.1).c_str(), "[0.1]");
  CHECK_TEXT(array_of(std::numeric_limits<double>::quiet_NaN()).c_str(), "[null]");
  CHECK_TEXT(array_of(-std::numeric_limits<double>::infinity()).c_str(), "[null]");
  CHECK_EQUAL(std::strtod(array_of(1.0 / 3).c_str() + 1, nullptr) == 1.0 / 3, 1);
  CHECK_TEXT(Json().open('[').number(0.1f).close(']').str().c_str(), "[0.1]");
  // A reader of doubles rounds whole numbers past 2^53: they go as text.
  const std::string wholes =
      Json().open('[').whole(std::uint64_t{1} << 53).whole((std::uint64_t{1} << 53) + 1).close(']').str();
  CHECK_TEXT(wholes.c_str(), "[9007199254740992,\"9007199254740993\"]");
  const std::string nested = Json()
                                 .open('{')
                                 .key("a")
                                 .open('[')
                                 .close(']')
                                 .key("b")
                                 .open('{')
                                 .close('}')
                                 .key("c")
                                 .flag(true)
                                 .close('}')
                                 .str();
  CHECK_TEXT(nested.c_str(), "{\"a\":[],\"b\":{},\"c\":true}");
}

// RFC 4648, section 10.
static void base64_vectors() {
  const char *const rows[][2] = {{"", ""},
                                 {"f", "Zg=="},
                                 {"fo", "Zm8="},
                                 {"foo", "Zm9v"},
                                 {"foob", "Zm9vYg=="},
                                 {"fooba", "Zm9vYmE="},
                                 {"foobar", "Zm9vYmFy"}};
  for (const auto &row : rows)
    CHECK_TEXT(base64(std::vector<std::uint8_t>(row[0], row[0] + std::strlen(row[0]))).c_str(), row[1]);
  CHECK_TEXT(base64({0xff, 0xfe, 0xfd}).c_str(), "//79");
}

// The facts of a document that `fill` makes.
template <class Fill> static std::string facts_of(Fill &&fill, std::uint64_t rows = 100) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = nullptr;
  CHECK_EQUAL(conceg_doc_new(ctx, &doc), CONCEG_OK);
  fill(doc);
  Json json;
  json.open('{');
  put_facts(doc, rows, json);
  json.close('}');
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
  return json.str();
}

// Five rows of text and numbers with a unit.
static void put_any(conceg_doc *doc) {
  const double size[] = {0, 0.5, 1, 1.5, 2};
  conceg_array array = {};
  array.size = sizeof array, array.dtype = CONCEG_F64, array.rank = 1, array.shape[0] = 5;
  array.data = size, array.unit = "um^3";
  put_texts(doc, "/statistics/any/name", {"</script>0", "b", "c", "d", "e"});
  CHECK_EQUAL(conceg_doc_write(doc, "/statistics/any/size", &array), CONCEG_OK);
}

static void tables() {
  const std::string all = facts_of(put_any);
  CHECK(contains(all, "\"path\":\"/statistics/any\",\"rows\":5,\"shown\":5"));
  CHECK(contains(all, "\"unit\":\"um^3\",\"values\":[0,0.5,1,1.5,2]"));
  CHECK(!contains(all, "</script"));
  const std::string cut = facts_of(put_any, 2);
  CHECK(contains(cut, "\"rows\":5,\"shown\":2") && contains(cut, "\"values\":[0,0.5]"));
  CHECK(
      contains(all, "{\"path\":\"/statistics/any/size\",\"type\":\"f64\",\"unit\":\"um^3\",\"shape\":[5]}"));
}

// Nothing of /statistics is dropped silently: scalars, matrices, groups within groups, empty tables.
static void odd_tables() {
  const std::string json = facts_of([](conceg_doc *doc) {
    put_scalar(doc, "/statistics/alone", 7.0);
    put(doc, "/statistics/deep/er/x", std::vector<double>{1, 2});
    put(doc, "/statistics/matrix/m", std::vector<double>{1, 2, 3, 4}, 2);
    put(doc, "/statistics/wide/w", std::vector<double>(40), 20);
    put(doc, "/statistics/empty/e", std::vector<double>{});
    put(doc, "/statistics/uneven/a", std::vector<double>{1}),
        put(doc, "/statistics/uneven/b", std::vector<double>{1, 2});
  });
  CHECK(contains(json, "\"name\":\"\",\"path\":\"/statistics\"") && contains(json, "\"values\":[7]"));
  CHECK(contains(json, "\"name\":\"deep/er\""));
  CHECK(contains(json, "\"name\":\"m[0]\"") && contains(json, "\"values\":[1,3]") &&
        contains(json, "\"values\":[2,4]"));
  CHECK(contains(json, "\"left_out\":[\"/statistics/wide/w: 20 values a row\"]"));
  CHECK(contains(json, "\"name\":\"empty\",\"path\":\"/statistics/empty\",\"rows\":0,\"shown\":0"));
  CHECK(contains(json, "\"name\":\"uneven\",\"path\":\"/statistics/uneven\",\"rows\":2"));
  const std::string nothing = facts_of([](conceg_doc *) {});
  CHECK(contains(nothing, "\"tables\":[],\"arrays\":{},\"contents\":[]") &&
        contains(nothing, "\"recipe\":\"\""));
  CHECK(contains(nothing, "\"entry\":\"L23_pyramidal\",\"real\":{\"cells\":12"));
}

int main() {
  escapes(), numbers(), base64_vectors(), tables(), odd_tables();
  return check_done();
}
