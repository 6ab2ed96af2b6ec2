#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "tools/slam-eval/program/commands.hpp"

int main(int argc, char** argv) {
  CLI::App app{"Errors of an estimated trajectory against the truth by the definitions of evo, and pictures of maps."};
  app.require_subcommand(1);
  app.get_formatter()->column_width(44);
  slamd::eval::add_ape(app);
  slamd::eval::add_rpe(app);
  slamd::eval::add_relations(app);
  slamd::eval::add_picture(app);
  slamd::eval::add_tables(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::cerr << "slam-eval: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
