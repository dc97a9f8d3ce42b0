!> A shear frame of several storeys: masses at its floors, stiffnesses and heights of its storeys,
!> and what its modes make of them (Chopra, Dynamics of Structures, chapters 10 to 13).
module rwmf_problem_shear_frame
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_symmetric_eigen, only: solve_modes
   implicit none
   private

   public :: shear_frame_t, find_modes, enforce_straight_line, scale_masses
   public :: modal_mass, modal_height, roof_factor, base_shear_share, damping_matrix

   !> From the ground to the roof.
   type :: shear_frame_t
      real(wp), allocatable :: m(:)
      !! (n) mass of each floor over m_w; a frame without wall: over any mass [-]
      real(wp), allocatable :: k(:)
      !! (n) stiffness of the storey below each floor over the same mass [1/s2]
      real(wp), allocatable :: height(:)
      !! (n) of each storey [m]
      real(wp), allocatable :: omega(:)
      !! (n) frequencies of the frame by itself [rad/s]
      real(wp), allocatable :: shape(:, :)
      !! (n, n) its modes in columns: displacements of the floors, with unit modal mass
   end type shear_frame_t

contains

   !> Frequencies and modes from masses and stiffnesses. Fails with `err_numerical`.
   subroutine find_modes(frame, error)
      type(shear_frame_t), intent(inout) :: frame
      !! with m and k
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: stiffness(size(frame%m), size(frame%m))
      real(wp) :: mass(size(frame%m), size(frame%m))
      integer :: i
      integer :: n

      n = size(frame%m)
      stiffness = 0
      mass = 0
      do i = 1, n
         mass(i, i) = frame%m(i)
         stiffness(i, i) = frame%k(i)
      end do
      do i = 1, n - 1
         stiffness(i, i) = stiffness(i, i) + frame%k(i + 1)
         stiffness(i, i + 1) = -frame%k(i + 1)
         stiffness(i + 1, i) = -frame%k(i + 1)
      end do
      if (allocated(frame%omega)) deallocate (frame%omega, frame%shape)
      allocate (frame%omega(n), frame%shape(n, n))
      call solve_modes(stiffness, mass, frame%omega, frame%shape, error)
   end subroutine find_modes

   !> Put the straight line, with the frequency that Rayleigh's quotient gives it, in the place of
   !> the first mode: the only one left to a frame whose floors are all linked to a rigid wall.
   pure subroutine enforce_straight_line(frame)
      type(shear_frame_t), intent(inout) :: frame
      !! with its modes and heights
      real(wp) :: share(size(frame%m))
      !! of each storey in the height [-]
      real(wp) :: mass
      integer :: i

      share = frame%height/sum(frame%height)
      frame%shape(:, 1) = [(sum(share(:i)), i=1, size(share))]
      mass = sum(frame%m*frame%shape(:, 1)**2)
      frame%shape(:, 1) = frame%shape(:, 1)/sqrt(mass)
      frame%omega(1) = sqrt(sum(frame%k*share**2)/mass)
   end subroutine enforce_straight_line

   !> Scale all masses, and the stiffnesses with them: the periods stay, and the shapes.
   pure subroutine scale_masses(frame, factor)
      type(shear_frame_t), intent(inout) :: frame
      !! with its modes
      real(wp), intent(in) :: factor
      !! > 0 [-]

      frame%m = factor*frame%m
      frame%k = factor*frame%k
      frame%shape = frame%shape/sqrt(factor)
   end subroutine scale_masses

   !> L_j = sum of m_i phi_ij, Chopra's Eq. (13.2.3); its square is the effective modal mass.
   pure real(wp) function excitation(frame, mode)
      type(shear_frame_t), intent(in) :: frame
      integer, intent(in) :: mode

      excitation = dot_product(frame%m, frame%shape(:, mode))
   end function excitation

   !> Base shear effective modal mass, in the unit of m.
   pure real(wp) function modal_mass(frame, mode)
      type(shear_frame_t), intent(in) :: frame
      !! with its modes
      integer, intent(in) :: mode
      !! number, from the slowest

      modal_mass = excitation(frame, mode)**2
   end function modal_mass

   !> Effective modal height: where the modal mass makes the mode's overturning moment [m].
   pure real(wp) function modal_height(frame, mode) result(height)
      type(shear_frame_t), intent(in) :: frame
      !! with its modes
      integer, intent(in) :: mode
      !! number of the mode, in the order of the frequencies
      integer :: i

      height = 0
      do i = 1, size(frame%m)
         height = height + sum(frame%height(:i))*frame%m(i)*frame%shape(i, mode)
      end do
      height = height/excitation(frame, mode)
   end function modal_height

   !> Displacement of the roof over that of the mode's oscillator, Gamma phi_n [-].
   pure real(wp) function roof_factor(frame, mode)
      type(shear_frame_t), intent(in) :: frame
      !! with its modes
      integer, intent(in) :: mode
      !! number of the mode, in the order of the frequencies

      roof_factor = excitation(frame, mode)*frame%shape(size(frame%m), mode)
   end function roof_factor

   !> Shear of the lowest storey over the force at the roof that would bend the frame alike and do
   !> the same work, k_1 phi_1 phi_n/omega**2 [-]. Of a mode it is Gamma phi_n.
   pure real(wp) function base_shear_share(frame)
      type(shear_frame_t), intent(in) :: frame
      !! with its modes

      associate (shape => frame%shape(:, 1))
         base_shear_share = frame%k(1)*shape(1)*shape(size(shape))/frame%omega(1)**2
      end associate
   end function base_shear_share

   !> Damping matrix that gives every mode the same damping ratio, Chopra's Eq. (11.4.16)
   !> [1/s times the unit of m].
   pure function damping_matrix(frame, xi) result(c)
      type(shear_frame_t), intent(in) :: frame
      !! with its modes
      real(wp), intent(in) :: xi
      !! damping ratio [-]
      real(wp), allocatable :: c(:, :)
      !! (n, n)
      real(wp) :: momentum(size(frame%m))
      integer :: i, j

      allocate (c(size(frame%m), size(frame%m)))
      c = 0
      do j = 1, size(frame%m)
         momentum = frame%m*frame%shape(:, j)
         do i = 1, size(frame%m)
            c(:, i) = c(:, i) + 2*xi*frame%omega(j)*momentum*momentum(i)
         end do
      end do
   end function damping_matrix

end module rwmf_problem_shear_frame
