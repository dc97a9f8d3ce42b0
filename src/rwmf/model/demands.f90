!> What engineers design a building for, at one instant: drifts and accelerations of its floors,
!> shears of its storeys, the moment that overturns it, and the forces inside the wall.
!>
!> A frame with all modes says what each floor does. One mode, or the straight line that links to
!> every floor enforce, say it by their shape: floor i has the share phi_i/phi_n of the roof's
!> displacement, and its absolute acceleration is that share of the roof's and the ground's own. A
!> single degree of freedom is one floor without a storey.
module rwmf_model_demands
   use rwmf_core_kinds, only: pi, wp
   use rwmf_model_effects_p_delta, only: leaning_height, leaning_loads
   use rwmf_model_effects_storeys_shear_building, only: column_shears
   use rwmf_model_equation, only: equation_t, frame_displacement, frame_mass, frame_motion, &
      ground, kinematics_at, place_frame
   use rwmf_model_floor_motion, only: floor_motion
   use rwmf_model_hysteresis_bouc_wen, only: bouc_wen_force
   use rwmf_model_hysteresis_laws, only: spring_force
   use rwmf_model_kinematics, only: kinematics_t
   use rwmf_model_reactions, only: link_force, link_tilt, roof_acceleration
   use rwmf_model_wall_sections, only: find_section_extremes, link_places, links_t, &
      section_extremes_t
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: building_t, demands_t, building_of, demands_at, links_of

   !> What the demands need to know of a building beyond its equation of motion.
   type :: building_t
      integer :: floors = 0
      !! number of them, 0 without a frame
      integer :: drifts = 0
      !! number of storeys, each with its drift; 0 of a single degree of freedom
      real(wp) :: roof_height = 0
      !! of the wall, else of the frame; 0: unknown [m]
      real(wp) :: unit = 1
      !! mass that those of floors that move by themselves are over, in that of m [-]
      real(wp) :: weight = 0
      !! of wall and floors over the unit of m [m/s2]
      real(wp) :: viscous_time = 0
      !! 2 xi_s/omega_s: damping over stiffness of storeys that follow the roof [s]
      logical :: is_linear = .true.
      !! storeys do not yield
      real(wp), allocatable :: m(:)
      !! (floors) over m_w; without wall in the unit of the case [-]
      real(wp), allocatable :: z(:)
      !! (floors) height above the ground [m]; not allocated where it is unknown
      real(wp), allocatable :: share(:)
      !! (floors) of the roof's displacement where floors follow the roof [-]
      real(wp), allocatable :: height(:)
      !! (storeys) [m]
      real(wp), allocatable :: bend(:)
      !! (storeys) share of the roof's displacement in that of the storey [-]
      real(wp), allocatable :: k(:)
      !! (storeys) stiffness over the unit of m [1/s2]
      real(wp), allocatable :: load(:)
      !! (storeys) push of the weights that lean on each over its displacement, over the same [1/s2]
   end type building_t

   !> The demands of one instant, with their signs.
   type :: demands_t
      real(wp), allocatable :: drift(:)
      !! (storeys) over their heights [-]
      real(wp), allocatable :: acceleration(:)
      !! (floors) absolute [m/s2]
      real(wp), allocatable :: shear(:)
      !! (storeys) of columns without dampers, over the unit of m [m/s2]
      real(wp) :: overturning = 0
      !! moment of the horizontal forces of inertia about the ground over the weight [m]
      type(section_extremes_t) :: wall
      !! the largest forces inside it
      type(links_t) :: links
      !! what they come from
   end type demands_t

contains

   !> The building of a case.
   subroutine building_of(case, equation, building)
      type(case_t), intent(in) :: case
      !! with the frame's T_s
      type(equation_t), intent(in) :: equation
      !! of this case
      type(building_t), intent(out) :: building

      if (equation%has_wall) then
         building%weight = equation%p%g
         building%roof_height = 2*case%wall%h
      end if
      allocate (building%height(0), building%bend(0), building%k(0), building%load(0))
      if (.not. equation%has_frame) return
      if (allocated(case%storeys)) then
         call describe_storeys(case, equation, building)
      else
         building%floors = 1
         building%m = [frame_mass(equation)]
         building%share = [1.0_wp]
         if (.not. equation%has_wall) building%roof_height = leaning_height(case)
         if (building%roof_height > 0) building%z = [building%roof_height]
      end if
      building%weight = building%weight + equation%p%g*sum(building%m)
   end subroutine building_of

   !> A frame of storeys. In a spectrum all stiffnesses follow the period.
   subroutine describe_storeys(case, equation, building)
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      type(building_t), intent(inout) :: building
      integer :: n, i

      associate (frame => case%storeys%frame)
         n = size(frame%m)
         building%floors = n
         building%drifts = n
         building%m = frame%m
         building%height = frame%height
         building%z = [(sum(frame%height(:i)), i=1, n)]
         if (.not. equation%has_wall) building%roof_height = building%z(n)
         building%share = frame%shape(:, 1)/frame%shape(n, 1)
         building%bend = building%share - [0.0_wp, building%share(:n - 1)]
         building%k = frame%k*(2*pi/case%frame%T_s/frame%omega(1))**2
         building%load = leaning_loads(case)
         building%viscous_time = case%frame%xi_s*case%frame%T_s/pi
         building%is_linear = .not. allocated(case%yielding)
         building%unit = equation%floors%unit
      end associate
   end subroutine describe_storeys

   !> Demands at a state of motion; of a wall at rest with zeros for its motion.
   subroutine demands_at(building, equation, t, y, y_dot, demands)
      type(building_t), intent(in) :: building
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates
      type(demands_t), intent(inout) :: demands
      type(kinematics_t) :: kin
      real(wp) :: u_ddot(building%floors)
      !! accelerations of the floors relative to the ground [m/s2]
      real(wp) :: a

      a = ground(equation, t)
      if (equation%has_wall) kin = kinematics_at(equation, y(1))
      call follow_floors(building, equation, kin, y, y_dot, demands, u_ddot)
      demands%acceleration = u_ddot + a
      demands%overturning = 0
      if (allocated(building%z)) demands%overturning = sum(building%m*building%z &
         *demands%acceleration)
      if (equation%has_wall) then
         demands%overturning = demands%overturning + wall_overturning(equation, a, y, y_dot(2))
         call links_of(building, equation, kin, t, y, y_dot(2), demands%links)
         call find_section_extremes(equation, t, y, y_dot(2), demands%links, demands%wall)
      end if
      demands%overturning = demands%overturning/building%weight
   end subroutine demands_at

   !> Accelerations of the floors relative to the ground, drifts and shears of the storeys.
   subroutine follow_floors(building, equation, kin, y, y_dot, demands, u_ddot)
      type(building_t), intent(in) :: building
      type(equation_t), intent(in) :: equation
      type(kinematics_t), intent(in) :: kin
      !! of a wall
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_dot(:)
      type(demands_t), intent(inout) :: demands
      real(wp), intent(out) :: u_ddot(:)
      !! (floors) [m/s2]
      real(wp) :: u(0:building%floors), v(building%floors)

      if (.not. equation%has_frame) then
         demands%drift = u_ddot
         demands%shear = u_ddot
         return
      end if
      associate (n => building%floors, first => equation%floors%first)
         u_ddot(n) = y_dot(2)
         if (equation%has_wall) u_ddot(n) = roof_acceleration(equation, kin, y, y_dot(2))
         if (equation%floors%n > 0) then
            u_ddot(:n - 1) = y_dot(first + n - 1:first + 2*n - 3)
            call floor_motion(equation, equation%state%side, y, u, v)
            demands%shear = equation%floors%unit*column_shears(equation, y)
         else
            u_ddot = building%share*u_ddot(n)
            u(0) = 0
            u(1:) = building%share*frame_displacement(equation, equation%state%side, y)
            demands%shear = building%k*building%bend*resisting_displacements(building, equation, y)
         end if
         demands%drift = u(1:building%drifts) - u(0:building%drifts - 1)
         demands%drift = demands%drift/building%height
      end associate
   end subroutine follow_floors

   !> Displacement of the roof that an elastic storey would need for the force that each has: all
   !> the same where they yield together [m].
   function resisting_displacements(building, equation, y) result(u)
      type(building_t), intent(in) :: building
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp) :: u(building%drifts)
      real(wp) :: roof
      integer :: i, n

      roof = frame_displacement(equation, equation%state%side, y)
      u = roof
      if (equation%has_loading_direction) then
         u = bouc_wen_force(equation, y)/equation%p%omega_squared
      else if (allocated(equation%springs)) then
         n = count(equation%springs%place == place_frame)
         do i = 1, n
            associate (spring => equation%springs(i))
               u(i) = spring_force(spring%spring, equation%state%springs(i), roof) &
                  /(spring%share*equation%p%omega_squared)
            end associate
         end do
         if (n == 1) u = u(1)
      end if
   end function resisting_displacements

   !> Forces of the links on the wall.
   !>
   !> Where every floor is linked, its link pulls with the floor's inertia and the difference of the
   !> forces above and below: shears, dampers that lie in the storeys, less what leans on them.
   subroutine links_of(building, equation, kin, t, y, y_ddot, links)
      type(building_t), intent(in) :: building
      type(equation_t), intent(in) :: equation
      !! with a wall
      type(kinematics_t), intent(in) :: kin
      !! at this rotation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_ddot
      !! theta'' [rad/s2]
      type(links_t), intent(inout) :: links
      !! whose room may be used again
      real(wp), dimension(building%drifts) :: shear, a
      real(wp) :: u, v
      integer :: i, n

      n = min(1, building%floors)
      if (equation%floors%are_linked) n = building%floors
      if (.not. allocated(links%place)) allocate (links%place(2, n), links%force(2, n))
      if (.not. equation%floors%are_linked) then
         links%place(:, :) = link_places(equation, [(1.0_wp, i=1, n)])
         if (building%floors > 0) links%force(:, 1) = link_force(equation, kin, t, y, y_ddot)
         return
      end if
      call frame_motion(equation, equation%state%side, y, u, v)
      shear = building%bend*(building%k*(resisting_displacements(building, equation, y) &
         + building%viscous_time*v) - building%load*u)
      a = building%share*roof_acceleration(equation, kin, y, y_ddot) + ground(equation, t)
      links%place(:, :) = link_places(equation, building%share)
      links%force(1, :) = -building%m*a - shear
      links%force(1, :n - 1) = links%force(1, :n - 1) + shear(2:)
      links%force(2, :) = link_tilt(equation, kin)*links%force(1, :)
   end subroutine links_of

   !> Moment of the wall's horizontal inertia about the ground over m_w: of its centroid, and of
   !> what moves about that [m2/s2].
   pure real(wp) function wall_overturning(equation, ground_acceleration, y, y_ddot) result(moment)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: ground_acceleration
      !! [m/s2]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_ddot
      !! theta'' [rad/s2]
      real(wp) :: h, b, arm, sine, cosine, height, push

      h = equation%p%R*equation%p%cos_alpha
      b = equation%p%R*equation%p%sin_alpha
      ! from the axis to the pivot
      arm = equation%state%side*equation%p%R*equation%geometry%sine_wall
      sine = sin(y(1))
      cosine = cos(y(1))
      height = h*cosine + arm*sine
      push = ground_acceleration + height*y_ddot + (arm*cosine - h*sine)*y(2)**2
      moment = push*height + (y_ddot*(b**2*sine**2 + h**2*cosine**2) &
         - y(2)**2*(h**2 - b**2)*sine*cosine)/3
   end function wall_overturning

end module rwmf_model_demands
