// Gives the library of shared program code a translation unit even while src/nodes holds programs only.
