#include "support/json.hpp"

template class nlohmann::basic_json<>;
template class std::map<std::string, nlohmann::json, std::less<>>;
template class std::vector<nlohmann::json>;

namespace nlohmann::detail {
template class lexer<json, TextAdapter>;
template class parser<json, TextAdapter>;
template class serializer<json>;
template class json_sax_dom_parser<json>;
template class json_sax_dom_callback_parser<json>;
}  // namespace nlohmann::detail
