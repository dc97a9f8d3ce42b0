!> The wall as a beam: modes of the uniform cantilever that bends in the frame turning with the
!> base, and the floors that are linked to it all.
module rwmf_model_beam
   use rwmf_core_kinds, only: wp
   use rwmf_math_cantilever, only: cantilever_mode_t, deflection, find_cantilever_mode, &
      force_above, moment_above
   implicit none
   private

   public :: beam_t, linked_floors_t, create_beam, link_floors, tip_deflection, tip_rate

   !> Floors that follow a bent wall, each linked to it; values over m_w.
   type :: linked_floors_t
      real(wp), allocatable :: share(:)
      !! (floors) height over that of the wall [-]
      real(wp), allocatable :: m(:)
      !! (floors) mass [-]
      real(wp), allocatable :: k(:)
      !! (floors) stiffness of the storey below [1/s2]
      real(wp), allocatable :: load(:)
      !! (floors) push of the weights that lean on that storey per displacement [1/s2]
      real(wp) :: viscous_time = 0
      !! damping over stiffness [s]
      real(wp), allocatable :: phi(:, :)
      !! (floors, modes) deflection of each mode [-]
   end type linked_floors_t

   !> Modes of a wall; without `&bending` there are none. Masses are over m_w.
   type :: beam_t
      integer :: n = 0
      !! number of modes
      integer :: first = 0
      !! place of q_1 among the states; the velocities follow the displacements
      real(wp) :: length = 0
      !! 2h [m]
      real(wp) :: half_width = 0
      !! b [m]
      type(cantilever_mode_t), allocatable :: modes(:)
      !! (modes)
      real(wp), allocatable :: area(:)
      !! (modes) A_i: integral of phi_i over the height, over it [-]
      real(wp), allocatable :: arm(:)
      !! (modes) S_i: integral of z phi_i over the height, over it [m]
      real(wp), allocatable :: mass(:)
      !! (modes) integral of phi_i**2 over the height, over it [-]
      real(wp), allocatable :: omega(:)
      !! (modes) frequency of the wall on a fixed base [rad/s]
      real(wp), allocatable :: damping(:)
      !! (modes) damper over modal mass [1/s]
      real(wp), allocatable :: linked_mass(:, :)
      !! (modes, modes) of frame or floors at theta = 0 [-]
      type(linked_floors_t), allocatable :: floors
      !! only where every floor is linked
   end type beam_t

contains

   !> Modes of a wall on a fixed base.
   pure subroutine create_beam(beam, n, h, b, stiffness, shear_flexibility, xi, in_proportion)
      type(beam_t), intent(out) :: beam
      integer, intent(in) :: n
      !! number of modes
      real(wp), intent(in) :: h, b
      !! half height and half width [m]
      real(wp), intent(in) :: stiffness
      !! EI/m_w [m3/s2]
      real(wp), intent(in) :: shear_flexibility
      !! EI/(kappa G A (2h)**2), 0 for none [-]
      real(wp), intent(in) :: xi
      !! damping ratio [-]
      logical, intent(in) :: in_proportion
      !! to the stiffness, with that ratio in the first mode; else with it in each mode
      integer :: i

      beam%n = n
      beam%length = 2*h
      beam%half_width = b
      beam%modes = [(find_cantilever_mode(i, shear_flexibility), i=1, n)]
      beam%mass = beam%modes%norm
      beam%omega = sqrt(stiffness/beam%length**3)*beam%modes%a*beam%modes%c
      beam%damping = 2*xi*beam%omega
      if (in_proportion) beam%damping = beam%damping*beam%omega/beam%omega(1)
      beam%area = [(force_above(beam%modes(i), 0.0_wp), i=1, n)]
      beam%arm = [(beam%length*moment_above(beam%modes(i), 0.0_wp), i=1, n)]
      allocate (beam%linked_mass(n, n), source=0.0_wp)
   end subroutine create_beam

   !> Link floors to the beam, all of them.
   pure subroutine link_floors(beam, floors)
      type(beam_t), intent(inout) :: beam
      type(linked_floors_t), intent(in) :: floors
      !! without the deflections of the modes
      integer :: i, j, k

      beam%floors = floors
      allocate (beam%floors%phi(size(floors%m), beam%n))
      do i = 1, beam%n
         beam%floors%phi(:, i) = [(deflection(beam%modes(i), floors%share(k)), &
            k=1, size(floors%m))]
      end do
      do i = 1, beam%n
         do j = 1, beam%n
            beam%linked_mass(i, j) = sum(floors%m*beam%floors%phi(:, i)*beam%floors%phi(:, j))
         end do
      end do
   end subroutine link_floors

   !> Deflection of the top relative to the straight axis, positive as theta [m].
   pure real(wp) function tip_deflection(beam, y) result(w)
      type(beam_t), intent(in) :: beam
      real(wp), intent(in) :: y(:)
      !! (states)

      w = sum(y(beam%first:beam%first + beam%n - 1))
   end function tip_deflection

   !> Its rate [m/s].
   pure real(wp) function tip_rate(beam, y) result(w_dot)
      type(beam_t), intent(in) :: beam
      real(wp), intent(in) :: y(:)
      !! (states)

      w_dot = sum(y(beam%first + beam%n:beam%first + 2*beam%n - 1))
   end function tip_rate

end module rwmf_model_beam
