!> Modes of the uniform cantilever, in the frame that turns with the base of the wall, and the
!> floors that are linked to it.
module rwmf_model_beam
   use rwmf_core_kinds, only: wp
   use rwmf_math_cantilever, only: cantilever_mode_t, deflection, find_cantilever_mode, &
      force_above, moment_above
   use rwmf_math_symmetric_eigen, only: diagonalise
   implicit none
   private

   public :: beam_t, linked_floors_t, set_beam, set_floors, set_links, set_vectors
   public :: tip_deflection, tip_rate, link_deflections, set_damping_ratios

   !> Floors that are linked to a bending wall one by one. All values are over m_w.
   type :: linked_floors_t
      real(wp), allocatable :: share(:)
      !! (floors) height over the height of the wall [-]
      real(wp), allocatable :: m(:)
      !! (floors) mass [-]
      real(wp), allocatable :: k(:)
      !! (floors) stiffness of the storey below [1/s2]
      real(wp), allocatable :: load(:)
      !! (floors) P-Delta force of the leaning loads per storey displacement [1/s2]
      real(wp) :: viscous_time = 0
      !! damping over stiffness of the storeys [s]
      real(wp), allocatable :: phi(:, :)
      !! (floors, modes) deflection of each mode at each floor [-]
   end type linked_floors_t

   !> Modes of a wall, none without `&bending`. Masses are over m_w.
   type :: beam_t
      integer :: n = 0
      !! number of modes
      integer :: first = 0
      !! index of q_1 in the states; the velocities follow the displacements
      real(wp) :: length = 0
      !! height of the wall 2h [m]
      real(wp) :: half_width = 0
      !! half width of the wall b [m]
      type(cantilever_mode_t), allocatable :: modes(:)
      !! (modes) shapes
      real(wp), allocatable :: area(:)
      !! (modes) A_i: integral of phi_i over the height, over it [-]
      real(wp), allocatable :: arm(:)
      !! (modes) S_i: integral of z phi_i over the height, over it [m]
      real(wp), allocatable :: mass(:)
      !! (modes) integral of phi_i**2 over the height, over it [-]
      real(wp), allocatable :: omega(:)
      !! (modes) natural frequency of the wall on a fixed base [rad/s]
      real(wp), allocatable :: damping(:)
      !! (modes) damping coefficient over modal mass [1/s]
      real(wp), allocatable :: ratios(:, :)
      !! (up to 3 modes, 2) damping ratios of the wall with its floors, in contact and rocking [-]
      real(wp), allocatable :: linked_mass(:, :)
      !! (modes, modes) mass matrix of frame or floors at theta = 0 [-]
      real(wp), allocatable :: vectors(:, :)
      !! (modes, modes) columns V in which both mass matrices are diagonal: that of the modes is 1,
      !! the linked one has the following values [-]
      real(wp), allocatable :: linked_ratio(:)
      !! (modes) linked mass over that of the wall in each vector [-]
      real(wp), allocatable :: link_phi(:, :)
      !! (floors, modes) deflections at link springs [-]; allocated only with them
      type(linked_floors_t), allocatable :: floors
      !! allocated only if every floor is linked
   end type beam_t

contains

   !> Compute the modes of a wall on a fixed base.
   pure subroutine set_beam(beam, n, h, b, stiffness, shear_flexibility, xi, in_proportion)
      type(beam_t), intent(inout) :: beam
      !! beam, whose floors are kept
      integer, intent(in) :: n
      !! number of modes
      real(wp), intent(in) :: h, b
      !! half height and half width of the wall [m]
      real(wp), intent(in) :: stiffness
      !! bending stiffness EI over m_w [m3/s2]
      real(wp), intent(in) :: shear_flexibility
      !! flexibility in shear EI/(kappa G A (2h)**2), 0 without shear [-]
      real(wp), intent(in) :: xi
      !! damping ratio of this cantilever [-]
      logical, intent(in) :: in_proportion
      !! damping in proportion to the stiffness, with xi in the first mode; otherwise xi in each
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
   end subroutine set_beam

   !> Compute deflections and mass matrix of the linked floors.
   pure subroutine set_floors(beam)
      type(beam_t), intent(inout) :: beam
      !! modes, and floors without the deflections of the modes
      integer :: i, j

      allocate (beam%floors%phi(size(beam%floors%m), beam%n))
      associate (floors => beam%floors, phi => beam%floors%phi)
         do i = 1, beam%n
            phi(:, i) = [(deflection(beam%modes(i), floors%share(j)), j=1, size(floors%m))]
         end do
         do i = 1, beam%n
            do j = 1, beam%n
               beam%linked_mass(i, j) = sum(floors%m*phi(:, i)*phi(:, j))
            end do
         end do
      end associate
   end subroutine set_floors

   !> Compute the vectors in which the mass matrices of the modes and of the linked masses are
   !> diagonal.
   pure subroutine set_vectors(beam)
      type(beam_t), intent(inout) :: beam
      !! modes with linked masses
      real(wp) :: root(beam%n)
      integer :: i

      root = sqrt(beam%mass)
      allocate (beam%vectors(beam%n, beam%n), beam%linked_ratio(beam%n))
      call diagonalise(reshape([(beam%linked_mass(:, i)/(root*root(i)), i=1, beam%n)], &
         [beam%n, beam%n]), beam%linked_ratio, beam%vectors)
      do i = 1, beam%n
         beam%vectors(:, i) = beam%vectors(:, i)/root
      end do
   end subroutine set_vectors

   !> Compute the damping ratios of the first modes of the wall with the masses of its links.
   !>
   !> In contact the base is fixed; rocking it turns freely about a corner. Stiffness and damping
   !> are those of the wall. With K = diag(k), K**(-1/2) M K**(-1/2) has the eigenvalues 1/omega**2.
   pure subroutine set_damping_ratios(beam, mass, xi)
      type(beam_t), intent(inout) :: beam
      real(wp), intent(in) :: mass(0:, 0:)
      !! mass matrix of rotation and modes, with those masses [m2], [m], [-]
      real(wp), intent(in), optional :: xi
      !! ratio of the first rocking mode, which scales the damping; absent: the damping is known [-]
      real(wp) :: matrix(beam%n, beam%n), vectors(beam%n, beam%n)
      real(wp), dimension(beam%n) :: values, root
      integer :: i, j, k

      root = sqrt(beam%mass)*beam%omega
      allocate (beam%ratios(min(3, beam%n), 2))
      do k = 1, 2
         matrix = mass(1:, 1:)
         do j = 1, beam%n
            ! without a moment at the base, the rotation follows the modes
            if (k == 2) matrix(:, j) = matrix(:, j) - mass(1:, 0)*(mass(j, 0)/mass(0, 0))
            matrix(:, j) = matrix(:, j)/(root*root(j))
         end do
         call diagonalise(matrix, values, vectors)
         do i = 1, size(beam%ratios, 1)
            j = maxloc(values, dim=1)
            beam%ratios(i, k) = sum(beam%damping*(vectors(:, j)/beam%omega)**2)/(2*sqrt(values(j)))
            values(j) = 0
         end do
      end do
      if (.not. present(xi) .or. .not. beam%ratios(1, 2) > 0) return
      beam%damping = xi/beam%ratios(1, 2)*beam%damping
      beam%ratios = xi/beam%ratios(1, 2)*beam%ratios
   end subroutine set_damping_ratios

   !> Compute the deflections of the modes at link springs.
   pure subroutine set_links(beam, share)
      type(beam_t), intent(inout) :: beam
      real(wp), intent(in) :: share(:)
      !! (floors) height over the height of the wall [-]
      integer :: i, j

      allocate (beam%link_phi(size(share), beam%n))
      do i = 1, beam%n
         beam%link_phi(:, i) = [(deflection(beam%modes(i), share(j)), j=1, size(share))]
      end do
   end subroutine set_links

   !> Deflections of the wall at its link springs, positive as theta [m].
   pure function link_deflections(beam, y) result(w)
      type(beam_t), intent(in) :: beam
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: w(size(beam%link_phi, 1))

      w = matmul(beam%link_phi, y(beam%first:beam%first + beam%n - 1))
   end function link_deflections

   !> Deflection of the top from the straight axis, positive as theta [m].
   pure real(wp) function tip_deflection(beam, y) result(w)
      type(beam_t), intent(in) :: beam
      real(wp), intent(in) :: y(:)
      !! (states)

      w = sum(y(beam%first:beam%first + beam%n - 1))
   end function tip_deflection

   !> Rate of the deflection of the top [m/s].
   pure real(wp) function tip_rate(beam, y) result(w_dot)
      type(beam_t), intent(in) :: beam
      real(wp), intent(in) :: y(:)
      !! (states)

      w_dot = sum(y(beam%first + beam%n:beam%first + 2*beam%n - 1))
   end function tip_rate

end module rwmf_model_beam
