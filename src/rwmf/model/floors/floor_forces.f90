!> Forces on the floors of a frame: storeys, link springs and inertia.
!>
!> The floors have states, or links to a bending wall one by one.
module rwmf_model_floors_floor_forces
   use rwmf_core_kinds, only: wp
   use rwmf_model_beam, only: link_deflections
   use rwmf_model_equation, only: equation_t, floors_t, frame_displacement, frame_mass, &
      frame_motion, ground, straight_displacement
   use rwmf_model_floor_motion, only: floor_accelerations, floor_motion, storey_motion
   use rwmf_problem_quantity_values, only: values_t, put
   use rwmf_model_hysteresis_spring_laws, only: spring_energy
   use rwmf_model_spring, only: branch_t
   use rwmf_problem_quantity_table, only: id
   implicit none
   private

   public :: resistance, link_pulls, column_shears, storey_strain, floor_inertia
   public :: put_floors, forces_of_linked_floors, bent_frame_strain

contains

   !> Resisting forces of the storeys on floors and roof, K u + C v for elastic storeys [m/s2].
   function resistance(equation, y) result(force)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: force(equation%floors%n)
      real(wp), dimension(size(force)) :: shear, v
      real(wp) :: u_roof, v_roof

      call frame_motion(equation, equation%state%side, y, u_roof, v_roof)
      associate (floors => equation%floors, n => equation%floors%n, &
                 free => equation%floors%free, first => equation%floors%first)
         shear = shears_at(floors, equation%state%storey_branches, y, u_roof)
         v(n) = v_roof
         v(:free) = y(first + free:first + 2*free - 1)
         force = matmul(floors%c, v) + shear
         force(:n - 1) = force(:n - 1) - shear(2:)
      end associate
   end function resistance

   !> Forces with which the link springs pull the floors along with the wall [m/s2].
   pure function link_pulls(equation, y) result(pull)
      type(equation_t), intent(in) :: equation
      !! equation with link springs
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: pull(equation%floors%n)

      associate (floors => equation%floors)
         pull = floors%share*straight_displacement(equation, equation%state%side, y(1))
         if (equation%beam%n > 0) pull = pull + cos(y(1))*link_deflections(equation%beam, y)
         pull = floors%k_link*(pull - y(floors%first:floors%first + floors%n - 1))
      end associate
   end function link_pulls

   !> Shears of the storeys' columns, without dampers [m/s2].
   pure function column_shears(equation, y) result(shear)
      type(equation_t), intent(in) :: equation
      !! equation whose storeys have displacements (`storey_motion`)
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: shear(equation%floors%n_storeys)
      real(wp), dimension(size(shear)) :: d, d_dot

      if (equation%floors%n > 0) then
         shear = shears_at(equation%floors, equation%state%storey_branches, y, &
            frame_displacement(equation, equation%state%side, y))
         return
      end if
      call storey_motion(equation, equation%state%side, y, d, d_dot)
      shear = equation%state%storey_branches%slope*d
      if (allocated(equation%floors%laws)) then
         shear = shear + equation%floors%laws%force_at_z1*y(equation%floors%laws%place)
      else if (equation%floors%yields) then
         shear = shear + equation%state%storey_branches%offset
      end if
   end function column_shears

   !> Strain energy of the storeys [J/kg].
   real(wp) function storey_strain(equation, y, d) result(energy)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: d(:)
      !! (storeys) their displacements [m]

      associate (branches => equation%state%storey_branches, floors => equation%floors)
         if (allocated(floors%laws)) then
            energy = sum(branches%slope*d**2 + floors%laws%force_at_z1*floors%laws%u_y &
               *y(floors%laws%place)**2)/2
         else if (floors%yields) then
            energy = sum(spring_energy(floors%springs, branches, d))
         else
            energy = sum(branches%slope*d**2)/2
         end if
      end associate
   end function storey_strain

   !> Shears of the storeys' columns for a given displacement of the roof [m/s2].
   pure function shears_at(floors, branches, y, u_roof) result(shear)
      type(floors_t), intent(in) :: floors
      type(branch_t), intent(in) :: branches(:)
      !! (floors) active branches
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: u_roof
      !! displacement of the roof [m]
      real(wp) :: shear(floors%n)
      real(wp) :: u(0:floors%n)

      associate (n => floors%n, free => floors%free, first => floors%first)
         ! one by one: an array constructor would fetch memory
         u(0) = 0
         u(n) = u_roof
         u(1:free) = y(first:first + free - 1)
         shear = branches%slope*(u(1:) - u(:n - 1))
         if (allocated(floors%laws)) then
            shear = shear + floors%laws%force_at_z1*y(floors%laws%place)
         else if (floors%yields) then
            shear = shear + branches%offset
         end if
      end associate
   end function shears_at

   !> Rate of momentum of the floors beyond that implied by the motion of a linked roof [m/s2].
   !>
   !> One mode: the floors move in proportion to the roof, and the omitted modes follow the ground.
   !> All modes: the sum of the forces of storeys and link springs on the floors with states.
   !> Without storeys it is zero.
   real(wp) function floor_inertia(equation, t, y, u_ddot) result(inertia)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! time [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: u_ddot
      !! acceleration of the roof relative to the ground [m/s2]
      real(wp) :: force(equation%floors%n)

      if (allocated(equation%floors%m)) then
         force = resistance(equation, y)
         inertia = -sum(force(:equation%floors%free))
         if (allocated(equation%floors%k_link)) inertia = inertia + sum(link_pulls(equation, y))
      else
         inertia = frame_mass(equation)*(equation%floors%excited_mass_ratio - 1)*u_ddot &
            + equation%floors%mass*ground(equation, t)
      end if
   end function floor_inertia

   !> Write the history columns of the floors' displacements relative to the ground [m] and the
   !> interstorey drift ratios [-].
   subroutine put_floors(row, equation, y)
      type(values_t), intent(inout) :: row
      type(equation_t), intent(in) :: equation
      !! equation with all modes of the frame
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: u(0:size(equation%floors%m))
      real(wp) :: v(size(equation%floors%m))
      integer :: n

      n = size(v)
      call floor_motion(equation, equation%state%side, y, u, v)
      call put(row, id%floor_i_m, u(1:equation%floors%free))
      call put(row, id%storey_i_drift, (u(1:) - u(:n - 1))/equation%floors%height)
   end subroutine put_floors

   !> Strain energy of the frame of a single mass, or of linked floors [J/kg].
   real(wp) function bent_frame_strain(equation, y) result(energy)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: u_s, u_s_dot
      real(wp), dimension(equation%floors%n_storeys) :: d, d_dot

      energy = 0
      if (size(d) > 0 .and. equation%floors%n == 0) then
         call storey_motion(equation, equation%state%side, y, d, d_dot)
         energy = storey_strain(equation, y, d)
      else if (equation%has_frame) then
         call frame_motion(equation, equation%state%side, y, u_s, u_s_dot)
         energy = equation%p%gamma*(equation%p%omega_s*u_s)**2/2
      end if
   end function bent_frame_strain

   !> Forces of the links on the wall where every floor is linked. Each balances the inertia of its
   !> floor and the difference of the storey forces above and below.
   function forces_of_linked_floors(equation, t, y, y_dot) result(force)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:), y_dot(:)
      !! (states) and their rates
      real(wp) :: force(size(equation%beam%floors%m))
      !! (floors) over m_w [m/s2]
      real(wp) :: u(0:size(force)), v(size(force)), shear(size(force))

      call floor_motion(equation, equation%state%side, y, u, v)
      associate (floors => equation%beam%floors, n => size(force))
         v = u(1:) + floors%viscous_time*v
         shear = floors%k*(v - [0.0_wp, v(:n - 1)]) - floors%load*(u(1:) - u(:n - 1))
         if (equation%floors%yields) shear = shear + column_shears(equation, y) &
            - floors%k*(u(1:) - u(:n - 1))
         force = -floors%m*(floor_accelerations(equation, equation%state%side, y, y_dot) &
            + ground(equation, t)) - shear
         force(:n - 1) = force(:n - 1) + shear(2:)
      end associate
   end function forces_of_linked_floors

end module rwmf_model_floors_floor_forces
