!> Shear frame of several storeys: floor masses, storey stiffnesses and heights, and the modal
!> quantities (Chopra, Dynamics of Structures, chapters 10 to 13).
module rwmf_problem_shear_frame
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_math_symmetric_eigen, only: solve_modes
   implicit none
   private

   public :: floors_group, shear_frame_t, find_modes, enforce_straight_line, scale_masses
   public :: modal_mass, modal_height, roof_factor, base_shear_share, damping_matrix
   public :: stiffness_matrix

   character(*), parameter :: floors_group = 'storeys'
   !! group that describes the floors of a frame

   !> Shear frame; floors and storeys are numbered from the ground to the roof.
   type :: shear_frame_t
      real(wp), allocatable :: m(:)
      !! (n) mass of each floor over m_w; for a frame without a wall over any mass [-]
      real(wp), allocatable :: k(:)
      !! (n) stiffness of the storey below each floor, over the same mass [1/s2]
      real(wp), allocatable :: height(:)
      !! (n) height of each storey [m]
      real(wp), allocatable :: omega(:)
      !! (n) frequencies of the frame without the wall [rad/s]
      real(wp), allocatable :: shape(:, :)
      !! (n, n) mode shapes in columns: displacements of the floors, with unit modal mass
   end type shear_frame_t

contains

   !> Find frequencies and modes from masses and stiffnesses. Fails with `err_numerical`.
   subroutine find_modes(frame, error)
      type(shear_frame_t), intent(inout) :: frame
      !! with m and k
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: mass(size(frame%m), size(frame%m))
      integer :: i
      integer :: n

      n = size(frame%m)
      mass = 0
      do i = 1, n
         mass(i, i) = frame%m(i)
      end do
      if (allocated(frame%omega)) deallocate (frame%omega, frame%shape)
      allocate (frame%omega(n), frame%shape(n, n))
      call solve_modes(stiffness_matrix(frame%k), mass, frame%omega, frame%shape, error)
   end subroutine find_modes

   !> Stiffness matrix of storeys on top of each other [1/s2 times the unit of m].
   pure function stiffness_matrix(k) result(stiffness)
      real(wp), intent(in) :: k(:)
      !! (n) stiffness of each storey from the ground up, in the same unit
      real(wp) :: stiffness(size(k), size(k))
      integer :: i

      stiffness = 0
      do i = 1, size(k)
         stiffness(i, i) = k(i)
      end do
      do i = 1, size(k) - 1
         stiffness(i, i) = stiffness(i, i) + k(i + 1)
         stiffness(i, i + 1) = -k(i + 1)
         stiffness(i + 1, i) = -k(i + 1)
      end do
   end function stiffness_matrix

   !> Replace the first mode by a straight line, with the frequency of its Rayleigh quotient. A
   !> frame whose floors are all linked to a rigid wall has only this mode.
   pure subroutine enforce_straight_line(frame)
      type(shear_frame_t), intent(inout) :: frame
      !! with its modes and heights
      real(wp) :: share(size(frame%m))
      !! ratio of each storey height to the total height [-]
      real(wp) :: mass
      integer :: i

      share = frame%height/sum(frame%height)
      frame%shape(:, 1) = [(sum(share(:i)), i=1, size(share))]
      mass = sum(frame%m*frame%shape(:, 1)**2)
      frame%shape(:, 1) = frame%shape(:, 1)/sqrt(mass)
      frame%omega(1) = sqrt(sum(frame%k*share**2)/mass)
   end subroutine enforce_straight_line

   !> Scale all masses and stiffnesses by one factor, which keeps periods and mode shapes.
   pure subroutine scale_masses(frame, factor)
      type(shear_frame_t), intent(inout) :: frame
      !! with its modes
      real(wp), intent(in) :: factor
      !! > 0 [-]

      frame%m = factor*frame%m
      frame%k = factor*frame%k
      frame%shape = frame%shape/sqrt(factor)
   end subroutine scale_masses

   !> Excitation factor L_j = sum of m_i phi_ij, Chopra's Eq. (13.2.3).
   pure real(wp) function excitation(frame, mode)
      type(shear_frame_t), intent(in) :: frame
      integer, intent(in) :: mode

      excitation = dot_product(frame%m, frame%shape(:, mode))
   end function excitation

   !> Effective modal mass for the base shear, in the unit of m.
   pure real(wp) function modal_mass(frame, mode)
      type(shear_frame_t), intent(in) :: frame
      !! with its modes
      integer, intent(in) :: mode
      !! number of the mode, in the order of the frequencies

      modal_mass = excitation(frame, mode)**2
   end function modal_mass

   !> Effective modal height, the lever arm of the modal mass in the mode's overturning moment [m].
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

   !> Displacement of the roof over that of the modal oscillator, Gamma phi_n [-].
   pure real(wp) function roof_factor(frame, mode)
      type(shear_frame_t), intent(in) :: frame
      !! with its modes
      integer, intent(in) :: mode
      !! number of the mode, in the order of the frequencies

      roof_factor = excitation(frame, mode)*frame%shape(size(frame%m), mode)
   end function roof_factor

   !> Base shear over the equivalent roof force, k_1 phi_1 phi_n/omega**2 [-].
   !>
   !> The equivalent force causes the same deflection and does the same work. For a mode the ratio
   !> is Gamma phi_n.
   pure real(wp) function base_shear_share(frame)
      type(shear_frame_t), intent(in) :: frame
      !! with its modes

      associate (shape => frame%shape(:, 1))
         base_shear_share = frame%k(1)*shape(1)*shape(size(shape))/frame%omega(1)**2
      end associate
   end function base_shear_share

   !> Damping matrix with the same damping ratio in every mode, Chopra's Eq. (11.4.16)
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
