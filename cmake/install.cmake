# SPDX-License-Identifier: Apache-2.0
# `cmake --install`: the program, what it reads at run time (rtl/generate/data_files.hpp), its manual page and shell completions.
# Everything but the program is found from where the program lies, so the folder may be moved as a whole.
install(TARGETS photonloom RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})

# rtl/ and fpga/ without the sources of programs: RTL, cell models, plans, boards and templates.
set(share ${CMAKE_INSTALL_DATADIR}/photonloom)
set(programs PATTERN "*.cpp" EXCLUDE PATTERN "*.hpp" EXCLUDE PATTERN "*.py" EXCLUDE PATTERN "__pycache__" EXCLUDE
  PATTERN "CMakeLists.txt" EXCLUDE)
install(DIRECTORY rtl fpga DESTINATION ${share} ${programs})
# Kernels are sources that are compiled per plan.
install(DIRECTORY hls_kernels DESTINATION ${share} PATTERN "generate" EXCLUDE)
install(DIRECTORY scenes DESTINATION ${share} FILES_MATCHING PATTERN "*.xml" PATTERN "*.obj" PATTERN "*.ply"
  PATTERN "meshes/*.png" PATTERN "meshes/*.exr" PATTERN "references" EXCLUDE)
install(DIRECTORY studies DESTINATION ${share} FILES_MATCHING PATTERN "*.toml")
install(FILES LICENSE DESTINATION ${share})

# Written by the program itself, from its own commands.
set(manual ${CMAKE_BINARY_DIR}/manual)
set(pages photonloom.1 photonloom.bash _photonloom photonloom.fish)
set(kinds man bash zsh fish)
set(written)
foreach(page kind IN ZIP_LISTS pages kinds)
  list(APPEND written ${manual}/${page})
  add_custom_command(OUTPUT ${manual}/${page} COMMAND photonloom manual ${kind} -o ${manual}/${page}
    DEPENDS photonloom COMMENT "Writing manual/${page}" VERBATIM)
endforeach()
file(MAKE_DIRECTORY ${manual})
add_custom_target(manual ALL DEPENDS ${written})
install(FILES ${manual}/photonloom.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${manual}/photonloom.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME photonloom)
install(FILES ${manual}/_photonloom DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
install(FILES ${manual}/photonloom.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
