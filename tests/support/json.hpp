#pragma once
// nlohmann::json for tests. json.cpp instantiates the parts that every source would otherwise instantiate itself, which
// is half of its code.

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

extern template class nlohmann::basic_json<>;
extern template class std::map<std::string, nlohmann::json, std::less<>>;
extern template class std::vector<nlohmann::json>;

namespace nlohmann::detail {
/// The adapter with which json::parse reads a string.
using TextAdapter = iterator_input_adapter<std::string::const_iterator>;
extern template class lexer<json, TextAdapter>;
extern template class parser<json, TextAdapter>;
extern template class serializer<json>;
extern template class json_sax_dom_parser<json>;
extern template class json_sax_dom_callback_parser<json>;
}  // namespace nlohmann::detail
