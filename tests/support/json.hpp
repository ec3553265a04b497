#pragma once
// nlohmann::json for tests. What every source would otherwise make for itself, half of its code, is made once, in
// json.cpp.

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

extern template class nlohmann::basic_json<>;
extern template class std::map<std::string, nlohmann::json, std::less<>>;
extern template class std::vector<nlohmann::json>;

namespace nlohmann::detail {
/// How json::parse reads a string.
using TextAdapter = iterator_input_adapter<std::string::const_iterator>;
extern template class lexer<json, TextAdapter>;
extern template class parser<json, TextAdapter>;
extern template class serializer<json>;
extern template class json_sax_dom_parser<json>;
extern template class json_sax_dom_callback_parser<json>;
}  // namespace nlohmann::detail
