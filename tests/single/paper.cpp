// The single header of the paper's methods is the first and only one here: it brings the other, Eigen, and all that it needs.
#include "../../single_include/hmesh_paper.hpp"

bool paper_is_there();  // alone.cpp

bool paper_is_there() {
    Eigen::SparseMatrix<double> matrix(3, 3);
    matrix.setIdentity();
    matrix *= 2;
    Eigen::MatrixXd solution = Eigen::MatrixXd::Zero(3, 2);
    const hmesh::kit::PcgReport report = hmesh::kit::solve_pcg(matrix, Eigen::MatrixXd::Ones(3, 2), solution);
    return report.converged && solution == Eigen::MatrixXd::Constant(3, 2, 0.5) && hmesh::Hierarchical().check() &&
           hmesh::Xie().check() && hmesh::AdaptiveThinning().check(640, 480);
}
