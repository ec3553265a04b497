#include "house/elf_file.hpp"

#include <elf.h>

#include <cstring>
#include <span>

#include "support/files.hpp"

namespace palpa::test {
namespace {

/// `count` consecutive structures of a file.
template <typename T>
std::vector<T> structures(const std::string& bytes, std::size_t offset, std::size_t count) {
  if (offset > bytes.size() || count > (bytes.size() - offset) / sizeof(T)) return {};
  std::vector<T> all(count);
  if (count > 0) std::memcpy(all.data(), bytes.data() + offset, count * sizeof(T));
  return all;
}

/// The offset in the file of the bytes at an address.
std::size_t offset_of(const std::vector<Elf64_Phdr>& segments, Elf64_Addr address) {
  for (const Elf64_Phdr& s : segments) {
    if (s.p_type == PT_LOAD && address >= s.p_vaddr && address - s.p_vaddr < s.p_filesz)
      return address - s.p_vaddr + s.p_offset;
  }
  return ~std::size_t{0};
}

std::string text_at(const std::string& bytes, std::size_t offset) {
  return offset < bytes.size() ? std::string(bytes.c_str() + offset) : std::string();
}

void read_dynamic(ElfFile& elf, const std::string& bytes, const std::vector<Elf64_Phdr>& segments,
                  std::span<const Elf64_Dyn> entries) {
  std::size_t strings = 0;
  for (const Elf64_Dyn& entry : entries) {
    if (entry.d_tag == DT_STRTAB) strings = offset_of(segments, entry.d_un.d_ptr);
  }
  for (const Elf64_Dyn& entry : entries) {
    if (entry.d_tag == DT_NEEDED) elf.needed.push_back(text_at(bytes, strings + entry.d_un.d_val));
    if (entry.d_tag == DT_RPATH || entry.d_tag == DT_RUNPATH) elf.search = text_at(bytes, strings + entry.d_un.d_val);
    elf.binds_at_start |= entry.d_tag == DT_BIND_NOW || (entry.d_tag == DT_FLAGS && entry.d_un.d_val & DF_BIND_NOW) ||
                          (entry.d_tag == DT_FLAGS_1 && entry.d_un.d_val & DF_1_NOW);
  }
}

void read_symbols(ElfFile& elf, const std::string& bytes, const Elf64_Ehdr& head) {
  const auto sections = structures<Elf64_Shdr>(bytes, head.e_shoff, head.e_shnum);
  for (const Elf64_Shdr& section : sections) {
    if (section.sh_type != SHT_DYNSYM || section.sh_link >= sections.size()) continue;
    const std::size_t strings = sections[section.sh_link].sh_offset;
    for (const auto& symbol : structures<Elf64_Sym>(bytes, section.sh_offset, section.sh_size / sizeof(Elf64_Sym))) {
      if (symbol.st_shndx == SHN_UNDEF) elf.imported.push_back(text_at(bytes, strings + symbol.st_name));
    }
  }
}

}  // namespace

std::optional<ElfFile> read_elf(const std::filesystem::path& file) {
  const std::string bytes = read_text(file);
  const auto heads = structures<Elf64_Ehdr>(bytes, 0, 1);
  if (heads.empty() || std::memcmp(heads[0].e_ident, ELFMAG, SELFMAG) != 0 || heads[0].e_ident[EI_CLASS] != ELFCLASS64)
    return std::nullopt;
  const auto segments = structures<Elf64_Phdr>(bytes, heads[0].e_phoff, heads[0].e_phnum);
  ElfFile elf;
  elf.position_independent = heads[0].e_type == ET_DYN;
  bool dynamic = false;
  for (const Elf64_Phdr& s : segments) {
    elf.program |= s.p_type == PT_INTERP;
    elf.read_only_after_relocation |= s.p_type == PT_GNU_RELRO;
    if (s.p_type == PT_GNU_STACK) elf.executable_stack = (s.p_flags & PF_X) != 0;
    if (s.p_type == PT_LOAD && s.p_flags & PF_X && s.p_offset < bytes.size())
      elf.code += bytes.substr(s.p_offset, s.p_filesz);
    if (s.p_type != PT_DYNAMIC) continue;
    dynamic = true;
    read_dynamic(elf, bytes, segments, structures<Elf64_Dyn>(bytes, s.p_offset, s.p_filesz / sizeof(Elf64_Dyn)));
  }
  if (!dynamic) return std::nullopt;
  read_symbols(elf, bytes, heads[0]);
  return elf;
}

}  // namespace palpa::test
