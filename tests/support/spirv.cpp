#include "support/spirv.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>

namespace palpa::test {
namespace {

// The SPIR-V opcodes and decorations that describe layout and accesses.
enum : std::uint32_t {
  op_name = 5,
  op_member_name = 6,
  op_execution_mode = 16,
  op_type_array = 28,
  op_type_runtime_array = 29,
  op_type_pointer = 32,
  op_constant = 43,
  op_variable = 59,
  op_load = 61,
  op_store = 62,
  op_copy_memory = 63,
  op_access_chain = 65,
  op_in_bounds_access_chain = 66,
  op_decorate = 71,
  op_member_decorate = 72,
  op_copy_object = 83,
  op_atomic_load = 227,
  op_atomic_store = 228,
  op_atomic_exchange = 229,
  op_atomic_xor = 242,
  op_execution_mode_id = 331,
  mode_local_size = 17,
  mode_local_size_id = 38,
  decoration_array_stride = 6,
  decoration_binding = 33,
  decoration_offset = 35,
  class_uniform_constant = 0
};

std::string text(std::span<const std::uint32_t> words) {
  std::string out;
  for (const std::uint32_t word : words) {
    for (int byte = 0; byte < 4; ++byte) {
      const char c = static_cast<char>(word >> (8 * byte));
      if (c == 0) return out;
      out += c;
    }
  }
  return out;
}

/// DeepMasks: deep_masks.
std::string in_small_letters(const std::string& name) {
  std::string out;
  for (const char c : name) {
    if (std::isupper(static_cast<unsigned char>(c)) && !out.empty()) out += '_';
    out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return out;
}

/// Where an instruction has the pointers that it reads and writes through; 0: none.
struct Places {
  std::uint32_t reads = 0, writes = 0, adds = 0;
};

Places places_of(std::uint32_t op) {
  if (op == op_load) return {.reads = 3};
  if (op == op_store) return {.writes = 1};
  if (op == op_copy_memory) return {.reads = 2, .writes = 1};
  if (op == op_atomic_load) return {.reads = 3};
  if (op == op_atomic_store) return {.adds = 1};
  if (op >= op_atomic_exchange && op <= op_atomic_xor) return {.adds = 3};
  return {};
}

}  // namespace

SpirvModule read_spirv(std::span<const std::uint32_t> words) {
  if (words.size() < 5 || words[0] != 0x07230203) throw std::runtime_error("no SPIR-V module");
  SpirvModule module;
  std::map<std::uint32_t, std::string> names;
  std::map<std::uint32_t, std::map<std::uint32_t, std::string>> member_names;
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> member_offsets;
  std::map<std::uint32_t, std::uint32_t> strides, element_types, constants, binding_numbers, pointees;
  struct Variable {
    std::uint32_t pointer = 0, storage = 0;
  };
  std::map<std::uint32_t, Variable> variables;
  std::vector<std::uint32_t> local_size_ids;
  for (std::size_t at = 5; at < words.size();) {
    const std::uint32_t length = words[at] >> 16, op = words[at] & 0xffff;
    if (length == 0 || at + length > words.size()) throw std::runtime_error("truncated SPIR-V module");
    const auto w = words.subspan(at, length);
    switch (op) {
      case op_name:
        names[w[1]] = text(w.subspan(2));
        break;
      case op_member_name:
        member_names[w[1]][w[2]] = text(w.subspan(3));
        break;
      case op_execution_mode:
        if (w[2] == mode_local_size) module.local_size = {w[3], w[4], w[5]};
        break;
      case op_execution_mode_id:
        if (w[2] == mode_local_size_id) local_size_ids.assign(w.begin() + 3, w.end());
        break;
      case op_constant:
        constants[w[2]] = w[3];
        break;
      case op_type_array:
      case op_type_runtime_array:
        element_types[w[1]] = w[2];
        break;
      case op_type_pointer:
        pointees[w[1]] = w[3];
        break;
      case op_variable:
        variables[w[2]] = {w[1], w[3]};
        break;
      case op_decorate:
        if (w[2] == decoration_binding) binding_numbers[w[1]] = w[3];
        if (w[2] == decoration_array_stride) strides[w[1]] = w[3];
        break;
      case op_member_decorate:
        if (w[3] == decoration_offset) member_offsets[w[1]][w[2]] = w[4];
        break;
      default:
        break;
    }
    at += length;
  }
  for (std::size_t i = 0; i < local_size_ids.size() && i < 3; ++i)
    module.local_size[i] = constants[local_size_ids[i]];
  for (const auto& [id, number] : binding_numbers) {
    const Variable& variable = variables.at(id);
    const bool texels = variable.storage == class_uniform_constant;
    module.bindings.push_back({number, names[texels ? id : pointees.at(variable.pointer)], texels});
  }
  std::stable_sort(module.bindings.begin(), module.bindings.end(),
                   [](const SpirvBinding& a, const SpirvBinding& b) { return a.number < b.number; });
  for (const auto& [id, offsets] : member_offsets) {
    for (const auto& [member, offset] : offsets)
      module.structs[names[id]].offsets[member_names[id][member]] = offset;
  }
  for (const auto& [array, stride] : strides) {
    if (element_types.count(array)) module.array_strides[names[element_types[array]]] = stride;
  }
  return module;
}

SpirvModule read_spirv(const gpu::Kernel& kernel) {
  SpirvModule module = read_spirv(kernel.words);
  std::vector<bool> named(kernel.bindings.size());
  for (const auto& [number, name, texels] : module.bindings) {
    const std::string spelt = texels ? name : in_small_letters(name);
    if (number >= named.size() || kernel.bindings[number].texels != texels ||
        !spelt.starts_with(kernel.bindings[number].name)) {
      throw std::runtime_error(std::string(kernel.name) + " binds " + name + " elsewhere than its table says");
    }
    if (spelt == kernel.bindings[number].name) named[number] = true;
  }
  if (std::find(named.begin(), named.end(), false) != named.end()) {
    throw std::runtime_error(std::string(kernel.name) + " does not bind all that its table names");
  }
  return module;
}

std::vector<Access> accesses_of(const gpu::Kernel& kernel) {
  std::map<std::uint32_t, std::uint32_t> binding_numbers, roots;  // variable -> binding, pointer -> variable
  std::vector<Access> accesses(kernel.bindings.size());
  const auto of = [&](std::uint32_t pointer) -> Access* {
    const auto root = roots.find(pointer);
    return root != roots.end() ? &accesses.at(binding_numbers.at(root->second)) : nullptr;
  };
  const std::span words = kernel.words;
  for (std::size_t at = 5, length = 0; at < words.size(); at += length) {
    length = words[at] >> 16;
    if (length == 0 || at + length > words.size()) throw std::runtime_error("truncated SPIR-V module");
    const std::uint32_t op = words[at] & 0xffff;
    const auto w = words.subspan(at, length);
    if (op == op_decorate && w[2] == decoration_binding) binding_numbers[w[1]] = w[3];
    if (op == op_variable && binding_numbers.contains(w[2])) roots[w[2]] = w[2];
    if (op == op_access_chain || op == op_in_bounds_access_chain || op == op_copy_object) {
      if (const auto root = roots.find(w[3]); root != roots.end()) roots[w[2]] = root->second;
    }
    const Places places = places_of(op);
    if (places.reads != 0) {
      if (Access* access = of(w[places.reads])) access->reads = true;
    }
    if (places.writes != 0) {
      if (Access* access = of(w[places.writes])) access->writes = true;
    }
    if (places.adds != 0) {
      if (Access* access = of(w[places.adds])) access->adds = true;
    }
  }
  return accesses;
}

}  // namespace palpa::test
