# Writes HEADER: the commit that SOURCE is at, as PALPA_COMMIT. Run at each build; the header changes only with the
# commit. PALPA_COMMIT in the environment replaces it, for sources without their history. Otherwise, such sources have
# none.
cmake_minimum_required(VERSION 3.25)
set(commit "$ENV{PALPA_COMMIT}")
if(commit STREQUAL "" AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND git -c safe.directory=* -C ${SOURCE} rev-parse --verify --quiet HEAD OUTPUT_VARIABLE commit
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
string(SUBSTRING "${commit}" 0 12 commit)
file(CONFIGURE OUTPUT ${HEADER} CONTENT "#define PALPA_COMMIT \"@commit@\"\n" @ONLY)
